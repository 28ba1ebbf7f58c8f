//! Signing keys of a laboratory. A valid signature proves that the owner of the key signed the archive and that the
//! archive is unchanged (docs/formats/archive.md#signature).

use std::fs::File;
use std::io::Write;
use std::path::Path;

use ed25519_dalek::{Signature, Signer, SigningKey, VerifyingKey};
use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;
use novamind_record::files::{create_private_file, parent_folder, sync_folder};

const PRIVATE_KEY_TITLE: &str = "novamind lab key 1: keep it secret, and keep a copy";
const PUBLIC_KEY_TITLE: &str = "novamind lab public key 1";
const SEAL_KEY_TITLE: &str = "novamind seal key 1: keep it secret";
/// Context string that separates the seal key from other keys that BLAKE3 derives from the lab key.
const SEAL_KEY_CONTEXT: &str = "novamind 2026-11 seal key of a lab";
/// Prefix of every signed message, so that signatures are valid only for seals of archives.
const SIGNATURE_CONTEXT: &[u8] = b"novamind seal of an archive 1\n";

/// Private signing key of a laboratory.
pub struct LabKey(SigningKey);

/// Public key of a laboratory, which verifies signatures of its private key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LabPublicKey(VerifyingKey);

/// Contents of `seal.sig`: signer and signature.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SignatureFile {
    algorithm: String,
    key: String,
    signature: String,
}

impl LabKey {
    /// Generates a private key.
    ///
    /// # Errors
    /// The system provides no random numbers.
    pub fn generate() -> Result<LabKey, RunError> {
        let mut secret = [0; 32];
        getrandom::fill(&mut secret).map_err(|error| {
            RunError::InvalidRequest(format!(
                "cannot create a key: the system provides no random numbers ({error})"
            ))
        })?;
        Ok(LabKey(SigningKey::from_bytes(&secret)))
    }

    /// Reads the private key from `lab.key`.
    ///
    /// # Errors
    /// The file cannot be read or is not a private key.
    pub fn read(file: &Path) -> Result<LabKey, RunError> {
        Ok(LabKey(SigningKey::from_bytes(&read_key_file(file, PRIVATE_KEY_TITLE)?)))
    }

    /// Writes the private key to a new file that only its owner can read.
    ///
    /// # Errors
    /// The file exists, or cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), RunError> {
        write_secret_file(file, &format_key_file(PRIVATE_KEY_TITLE, &self.0.to_bytes()))
    }

    /// Returns the secret that seals the snapshots of a study. The lab key cannot be derived from this secret.
    pub fn seal_secret(&self) -> [u8; 32] {
        blake3::derive_key(SEAL_KEY_CONTEXT, &self.0.to_bytes())
    }

    /// Returns the public key of this private key.
    pub fn public_key(&self) -> LabPublicKey {
        LabPublicKey(self.0.verifying_key())
    }

    /// Signs the text of a seal. Returns the contents of `seal.sig`.
    pub(super) fn sign(&self, seal: &str) -> String {
        let file = SignatureFile {
            algorithm: "ed25519".to_owned(),
            key: to_hex(self.public_key().0.as_bytes()),
            signature: to_hex(&self.0.sign(&signed_message(seal)).to_bytes()),
        };
        toml::to_string(&file).expect("a signature holds plain values")
    }
}

impl LabPublicKey {
    /// Reads the public key from `lab.pub`.
    ///
    /// # Errors
    /// The file cannot be read or is not a public key.
    pub fn read(file: &Path) -> Result<LabPublicKey, RunError> {
        let bytes = read_key_file(file, PUBLIC_KEY_TITLE)?;
        VerifyingKey::from_bytes(&bytes).map(LabPublicKey).map_err(|_| invalid_key_error(file))
    }

    /// Writes the public key to a new file.
    ///
    /// # Errors
    /// The file exists, or cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), RunError> {
        let text = format_key_file(PUBLIC_KEY_TITLE, self.0.as_bytes());
        let written = File::create_new(file).and_then(|mut out| out.write_all(text.as_bytes()));
        written.map_err(RunError::io(file))
    }

    /// Returns 16 hexadecimal digits that identify the key, for comparison by people.
    pub fn fingerprint(&self) -> String {
        let digits = blake3::hash(self.0.as_bytes()).to_hex();
        [&digits[..4], &digits[4..8], &digits[8..12], &digits[12..16]].join("-")
    }
}

/// Returns the signer of a seal, given the contents of `seal.sig`.
///
/// # Errors
/// Returns a description of the problem if the signature is not valid for the seal.
pub(super) fn verify_signature(seal: &str, signature: &str) -> Result<LabPublicKey, String> {
    let file: SignatureFile = toml::from_str(signature)
        .map_err(|error| format!("seal.sig cannot be read ({})", error.message()))?;
    if file.algorithm != "ed25519" {
        return Err(format!("seal.sig uses an unknown algorithm: {}", file.algorithm));
    }
    let invalid_signature = || "seal.sig is not a valid signature".to_owned();
    let key = VerifyingKey::from_bytes(&parse_hex(&file.key).ok_or_else(invalid_signature)?)
        .map_err(|_| invalid_signature())?;
    let signature = Signature::from_bytes(&parse_hex(&file.signature).ok_or_else(invalid_signature)?);
    key.verify_strict(&signed_message(seal), &signature)
        .map(|()| LabPublicKey(key))
        .map_err(|_| "seal.sig does not belong to seal.toml: one of them was changed".to_owned())
}

/// Reads the seal key from `seal.key`.
pub fn read_seal_key(file: &Path) -> Result<[u8; 32], RunError> {
    read_key_file(file, SEAL_KEY_TITLE)
}

/// Writes the seal key to a new file that only its owner can read.
pub fn write_seal_key(secret: &[u8; 32], file: &Path) -> Result<(), RunError> {
    write_secret_file(file, &format_key_file(SEAL_KEY_TITLE, secret))
}

fn write_secret_file(file: &Path, text: &str) -> Result<(), RunError> {
    let written = create_private_file(file)
        .and_then(|mut out| out.write_all(text.as_bytes()).and_then(|()| out.sync_all()));
    written.map_err(RunError::io(file))?;
    sync_folder(parent_folder(file))
}

fn signed_message(seal: &str) -> Vec<u8> {
    [SIGNATURE_CONTEXT, seal.as_bytes()].concat()
}

fn format_key_file(title: &str, key: &[u8; 32]) -> String {
    format!("{title}\n{}\n", to_hex(key))
}

fn read_key_file(file: &Path, title: &str) -> Result<[u8; 32], RunError> {
    let text = std::fs::read_to_string(file).map_err(RunError::io(file))?;
    let digits = text.trim_end().strip_prefix(title).map(str::trim);
    digits.and_then(parse_hex).ok_or_else(|| invalid_key_error(file))
}

fn invalid_key_error(file: &Path) -> RunError {
    RunError::InvalidRequest(format!(
        "{} is not a key file of this kind; nothing was changed",
        file.display()
    ))
}

fn to_hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn parse_hex<const COUNT: usize>(hex: &str) -> Option<[u8; COUNT]> {
    let fits = hex.len() == 2 * COUNT && hex.bytes().all(|digit| digit.is_ascii_hexdigit());
    let mut bytes = [0; COUNT];
    for (at, byte) in bytes.iter_mut().enumerate().filter(|_| fits) {
        *byte = u8::from_str_radix(&hex[2 * at..2 * at + 2], 16).ok()?;
    }
    fits.then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn key_files_round_trip_and_are_owner_only() {
        let folder = tempfile::tempdir().expect("a folder");
        let (path, public) = (folder.path().join("lab.key"), folder.path().join("lab.pub"));
        let key = LabKey::generate().expect("a key");
        key.write(&path).expect("written");
        key.public_key().write(&public).expect("written");
        assert_eq!(LabKey::read(&path).expect("a key").public_key(), key.public_key());
        assert_eq!(LabPublicKey::read(&public).expect("a key"), key.public_key());
        assert!(key.write(&path).is_err(), "a key is not overwritten");
        assert_ne!(
            LabKey::generate().expect("a key").public_key().fingerprint(),
            key.public_key().fingerprint()
        );
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = std::fs::metadata(&path).expect("a file").permissions().mode();
            assert_eq!(mode & 0o777, 0o600);
        }
        for text in ["", "novamind lab key 1", &std::fs::read_to_string(&public).expect("text")] {
            std::fs::write(&path, text).expect("written");
            let problem = LabKey::read(&path).err().expect("no key").to_string();
            assert!(problem.contains("is not a key file of this kind"), "{problem}");
        }
    }

    #[test]
    fn signature_is_valid_for_one_unchanged_seal() {
        let key = LabKey::generate().expect("a key");
        let (seal, signature) = ("format = 1\n", key.sign("format = 1\n"));
        assert_eq!(verify_signature(seal, &signature), Ok(key.public_key()));
        assert!(verify_signature("format = 2\n", &signature).is_err());
        for (at, letter) in signature.char_indices().filter(|(_, letter)| letter.is_ascii_alphanumeric()) {
            let other = if letter == '1' { "2" } else { "1" };
            let mut changed = signature.clone();
            changed.replace_range(at..=at, other);
            assert!(
                verify_signature(seal, &changed).is_err(),
                "the change of character {at} was not detected"
            );
        }
        // A signature with another key is valid, and verification returns that key.
        let other = LabKey::generate().expect("a key");
        assert_eq!(verify_signature(seal, &other.sign(seal)), Ok(other.public_key()));
    }
}
