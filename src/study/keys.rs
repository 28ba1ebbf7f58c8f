//! The keys of a study: `lab.key` signs archives, `lab.pub` tells who signed, `seal.key` seals snapshots.
//!
//! `seal.key` follows from `lab.key`, and nothing leads back: a machine that participants use needs it, and cannot sign.

use std::path::{Path, PathBuf};

use novamind_record::error::RunError;
use novamind_session::{LabKey, LabPublicKey, SealKey, read_seal_key, write_seal_key};

/// File of the private key.
pub const LAB_KEY_FILE: &str = "lab.key";
/// File of the public key.
pub const LAB_PUBLIC_KEY_FILE: &str = "lab.pub";
/// File of the key that seals snapshots.
pub const SEAL_KEY_FILE: &str = "seal.key";

/// Makes the keys of a study that its folder lacks; a `lab.key` that is there stays, and the others follow from it. Returns
/// the public key and the files that were written.
///
/// # Errors
/// The system gives no random numbers; a file cannot be read or written; `lab.pub` or `seal.key` is there without the
/// `lab.key` that it follows from.
pub fn make_keys(folder: &Path) -> Result<(LabPublicKey, Vec<PathBuf>), RunError> {
    let [own, public, seal] =
        [LAB_KEY_FILE, LAB_PUBLIC_KEY_FILE, SEAL_KEY_FILE].map(|name| folder.join(name));
    let orphan = [&public, &seal].into_iter().find(|path| path.exists()).filter(|_| !own.exists());
    if let Some(path) = orphan {
        return Err(RunError::NotPossible(format!(
            "{} follows from a {LAB_KEY_FILE} that is not in this folder: put it there, or remove {0}; nothing was written",
            path.display()
        )));
    }
    let mut written = Vec::new();
    let key = if own.exists() {
        LabKey::read(&own)?
    } else {
        let key = LabKey::generate()?;
        key.write(&own)?;
        written.push(own);
        key
    };
    if !public.exists() {
        key.public().write(&public)?;
        written.push(public);
    }
    if !seal.exists() {
        write_seal_key(&key.seal_secret(), &seal)?;
        written.push(seal);
    }
    Ok((key.public(), written))
}

/// What seals the snapshots of a study besides the runs: its `seal.key`; the runs alone where there is none.
///
/// # Errors
/// It cannot be read, or is no key.
pub fn seal_key_of(folder: &Path) -> Result<SealKey, RunError> {
    let file = folder.join(SEAL_KEY_FILE);
    if !file.exists() {
        return Ok(SealKey::default());
    }
    read_seal_key(&file).map(|secret| SealKey::of_study(&secret))
}

/// The key of the lab in the folder of a study, if it is there.
///
/// # Errors
/// It cannot be read, or is no key.
pub fn lab_key_of(folder: &Path) -> Result<Option<LabKey>, RunError> {
    let file = folder.join(LAB_KEY_FILE);
    file.exists().then(|| LabKey::read(&file)).transpose()
}

/// The public key of the lab in the folder of a study, if it is there.
///
/// # Errors
/// It cannot be read, or is no key.
pub fn lab_public_key_of(folder: &Path) -> Result<Option<LabPublicKey>, RunError> {
    let file = folder.join(LAB_PUBLIC_KEY_FILE);
    file.exists().then(|| LabPublicKey::read(&file)).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_lack_follow_from_the_one_that_is_there() {
        let folder = tempfile::tempdir().expect("a folder");
        let (public, written) = make_keys(folder.path()).expect("keys");
        assert_eq!(written.len(), 3);
        let seal = seal_key_of(folder.path()).expect("a key");
        assert!(seal != SealKey::default());
        std::fs::remove_file(folder.path().join(SEAL_KEY_FILE)).expect("gone");
        assert!(seal_key_of(folder.path()).expect("none") == SealKey::default());
        let (again, written) = make_keys(folder.path()).expect("keys");
        assert_eq!((again, written), (public, vec![folder.path().join(SEAL_KEY_FILE)]));
        assert!(seal_key_of(folder.path()).expect("a key") == seal);
        assert_eq!(lab_public_key_of(folder.path()).expect("a key"), Some(public));
        // Nobody makes another lab.key beside what an earlier one has left.
        std::fs::remove_file(folder.path().join(LAB_KEY_FILE)).expect("gone");
        let problem = make_keys(folder.path()).expect_err("the private key is elsewhere").to_string();
        assert!(problem.contains("lab.pub follows from a lab.key"), "{problem}");
        assert!(lab_key_of(folder.path()).expect("none").is_none());
        std::fs::write(folder.path().join(SEAL_KEY_FILE), "seal").expect("written");
        assert!(seal_key_of(folder.path()).is_err(), "a damaged key is told");
    }
}
