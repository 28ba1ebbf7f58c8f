//! The keys of a study: `lab.key` signs archives, `lab.pub` verifies signatures, `seal.key` seals snapshots.
//!
//! `seal.key` is derived from `lab.key`, and `lab.key` cannot be derived from `seal.key`. A participant's machine has
//! only `seal.key` and cannot sign archives.

use std::path::{Path, PathBuf};

use novamind_record::error::RunError;
use novamind_session::{LabKey, LabPublicKey, SealKey, read_seal_key, write_seal_key};

/// Name of the file that contains the private key of the lab.
pub const LAB_KEY_FILE: &str = "lab.key";
/// Name of the file that contains the public key of the lab.
pub const LAB_PUBLIC_KEY_FILE: &str = "lab.pub";
/// Name of the file that contains the key for sealing snapshots.
pub const SEAL_KEY_FILE: &str = "seal.key";

/// Creates the missing keys of a study. An existing `lab.key` is kept, and the other keys are derived from
/// it. Returns the public key and the paths of the written files.
///
/// # Errors
/// Returns an error if the system provides no random numbers, if a file cannot be read or written, or if
/// `lab.pub` or `seal.key` exists although `lab.key` is missing.
pub fn create_missing_keys(folder: &Path) -> Result<(LabPublicKey, Vec<PathBuf>), RunError> {
    let [lab_key, public, seal] =
        [LAB_KEY_FILE, LAB_PUBLIC_KEY_FILE, SEAL_KEY_FILE].map(|name| folder.join(name));
    let orphan = [&public, &seal].into_iter().find(|path| path.exists()).filter(|_| !lab_key.exists());
    if let Some(path) = orphan {
        return Err(RunError::InvalidRequest(format!(
            "{} was derived from a {LAB_KEY_FILE} that is not in this folder. Copy it here, or remove {0}; nothing was written",
            path.display()
        )));
    }
    let mut written = Vec::new();
    let key = if lab_key.exists() {
        LabKey::read(&lab_key)?
    } else {
        let key = LabKey::generate()?;
        key.write(&lab_key)?;
        written.push(lab_key);
        key
    };
    if !public.exists() {
        key.public_key().write(&public)?;
        written.push(public);
    }
    if !seal.exists() {
        write_seal_key(&key.seal_secret(), &seal)?;
        written.push(seal);
    }
    Ok((key.public_key(), written))
}

/// Returns the key that seals the snapshots of a study: its `seal.key`, or the default key if the file does not exist.
///
/// # Errors
/// Returns an error if the file cannot be read or is not a key.
pub fn load_seal_key(folder: &Path) -> Result<SealKey, RunError> {
    let file = folder.join(SEAL_KEY_FILE);
    if !file.exists() {
        return Ok(SealKey::default());
    }
    read_seal_key(&file).map(|secret| SealKey::with_study_secret(&secret))
}

/// Returns the private key of the lab in the folder of a study, or `None` if the file does not exist.
///
/// # Errors
/// Returns an error if the file cannot be read or is not a key.
pub fn load_lab_key(folder: &Path) -> Result<Option<LabKey>, RunError> {
    let file = folder.join(LAB_KEY_FILE);
    file.exists().then(|| LabKey::read(&file)).transpose()
}

/// Returns the public key of the lab in the folder of a study, or `None` if the file does not exist.
///
/// # Errors
/// Returns an error if the file cannot be read or is not a key.
pub fn load_lab_public_key(folder: &Path) -> Result<Option<LabPublicKey>, RunError> {
    let file = folder.join(LAB_PUBLIC_KEY_FILE);
    file.exists().then(|| LabPublicKey::read(&file)).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn create_missing_keys_derives_keys_from_the_lab_key() {
        let folder = tempfile::tempdir().expect("a folder");
        let (public, written) = create_missing_keys(folder.path()).expect("keys");
        assert_eq!(written.len(), 3);
        let seal = load_seal_key(folder.path()).expect("a key");
        assert!(seal != SealKey::default());
        std::fs::remove_file(folder.path().join(SEAL_KEY_FILE)).expect("gone");
        assert!(load_seal_key(folder.path()).expect("none") == SealKey::default());
        let (public_key, written) = create_missing_keys(folder.path()).expect("keys");
        assert_eq!((public_key, written), (public, vec![folder.path().join(SEAL_KEY_FILE)]));
        assert!(load_seal_key(folder.path()).expect("a key") == seal);
        assert_eq!(load_lab_public_key(folder.path()).expect("a key"), Some(public));
        // A new `lab.key` would not match the files that were derived from an earlier key.
        std::fs::remove_file(folder.path().join(LAB_KEY_FILE)).expect("gone");
        let problem =
            create_missing_keys(folder.path()).expect_err("the private key is elsewhere").to_string();
        assert!(problem.contains("lab.pub was derived from a lab.key"), "{problem}");
        assert!(load_lab_key(folder.path()).expect("none").is_none());
        std::fs::write(folder.path().join(SEAL_KEY_FILE), "seal").expect("written");
        assert!(load_seal_key(folder.path()).is_err(), "a damaged key is an error");
    }
}
