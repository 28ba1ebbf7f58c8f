//! The seal of an archive, `seal.toml`: a list of the archive's files with their hashes.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;

/// Format number of the seals that this program writes.
pub const SEAL_FORMAT: u32 = 1;

/// The seal of an archive, which reveals changes to its files.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seal {
    /// Format number of the archive.
    pub format: u32,
    /// Version of the program that created the archive.
    pub program: String,
    /// Time of the last line of the trajectory, RFC 3339.
    pub created: String,
    /// ID of the run.
    pub run: String,
    /// Number of the last line of the trajectory.
    pub last_seq: u64,
    /// Hash of the last line of the trajectory.
    pub last_hash: String,
    /// Hash of the seal with this field empty.
    pub checksum: String,
    /// All files of the archive except the seal and the signature.
    pub file: Vec<SealedFile>,
}

/// A file of an archive, as listed in the seal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SealedFile {
    /// Name of the file.
    pub name: String,
    /// Length of the file in bytes.
    pub bytes: u64,
    /// BLAKE3 hash of the file, in hexadecimal digits.
    pub blake3: String,
}

impl SealedFile {
    /// Reads a file and returns its name, length and hash.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn from_file(folder: &Path, name: &str) -> Result<SealedFile, RunError> {
        let path = folder.join(name);
        let mut file = File::open(&path).map_err(RunError::io(&path))?;
        let copied = copy_hashed(&mut file, &mut io::sink()).map_err(io::Error::from);
        let (bytes, blake3) = copied.map_err(RunError::io(&path))?;
        Ok(SealedFile { name: name.to_owned(), bytes, blake3 })
    }
}

impl Seal {
    /// Returns the seal with the checksum filled in.
    pub fn with_checksum(self) -> Seal {
        Seal { checksum: self.compute_checksum(), ..self }
    }

    /// Returns whether the checksum matches the seal.
    pub fn is_intact(&self) -> bool {
        self.checksum == self.compute_checksum()
    }

    /// Returns the seal as TOML.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("a seal holds plain values")
    }

    fn compute_checksum(&self) -> String {
        let bare = Seal { checksum: String::new(), ..self.clone() };
        blake3::hash(bare.to_toml().as_bytes()).to_hex().to_string()
    }
}

/// An error of a copy operation, by the end that failed: source or destination.
#[derive(Debug)]
pub enum CopyError {
    /// The source cannot be read.
    Read(io::Error),
    /// The destination cannot be written.
    Write(io::Error),
}

impl From<CopyError> for io::Error {
    fn from(error: CopyError) -> io::Error {
        match error {
            CopyError::Read(error) | CopyError::Write(error) => error,
        }
    }
}

/// Copies all bytes and returns their number and their BLAKE3 hash.
pub fn copy_hashed(from: &mut dyn Read, to: &mut dyn Write) -> Result<(u64, String), CopyError> {
    let (mut hasher, mut length) = (blake3::Hasher::new(), 0u64);
    let mut buffer = vec![0u8; 1 << 16];
    loop {
        let count = match from.read(&mut buffer) {
            Ok(0) => return Ok((length, hasher.finalize().to_hex().to_string())),
            Ok(count) => count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(CopyError::Read(error)),
        };
        hasher.update(&buffer[..count]);
        to.write_all(&buffer[..count]).map_err(CopyError::Write)?;
        length += count as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seal_detects_every_changed_character() {
        let file = SealedFile { name: "run.toml".to_owned(), bytes: 3, blake3: "00".to_owned() };
        let seal = Seal {
            format: SEAL_FORMAT,
            program: "0.1.0".to_owned(),
            created: "2026-11-21T10:00:00Z".to_owned(),
            run: "0123abcd".to_owned(),
            last_seq: 12,
            last_hash: "ff".to_owned(),
            checksum: String::new(),
            file: vec![file],
        };
        assert!(!seal.is_intact());
        let seal = seal.with_checksum();
        assert!(seal.is_intact());
        assert_eq!(toml::from_str::<Seal>(&seal.to_toml()).expect("it reads back"), seal);
        let text = seal.to_toml();
        for (at, byte) in text.bytes().enumerate().filter(|(_, byte)| byte.is_ascii_alphanumeric()) {
            let mut changed = text.clone().into_bytes();
            changed[at] = if byte == b'1' { b'2' } else { b'1' };
            let changed = String::from_utf8(changed).expect("ASCII");
            let accepted = toml::from_str::<Seal>(&changed).is_ok_and(|seal| seal.is_intact());
            assert!(!accepted, "the change of character {at} was not detected");
        }
    }
}
