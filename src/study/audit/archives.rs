//! Checks that archives in the folders of runs are signed by the lab of the study.

use std::path::{Path, PathBuf};

use super::{AuditFinding, FindingKind};
use crate::definition::Study;
use crate::keys::load_lab_public_key;
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_session::{LabPublicKey, TemporaryFolder, import_run, is_archive_name};

/// Returns a finding for each archive of the study that is damaged or not signed by the lab. Returns no findings if
/// the study has no public key.
///
/// # Errors
/// Returns an error if the public key cannot be read, or if no temporary folder can be created for unpacking.
pub(super) fn unsigned_archives(study: &Study, folders: &[PathBuf]) -> Result<Vec<AuditFinding>, RunError> {
    let Some(lab) = load_lab_public_key(&study.folder)? else { return Ok(Vec::new()) };
    let workshop = TemporaryFolder::create_in(&std::env::temp_dir())?;
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).into_iter().flatten().flatten());
    let mut archives: Vec<PathBuf> =
        entries.map(|entry| entry.path()).filter(|path| is_archive(path)).collect();
    archives.sort_unstable();
    let inspect = |(number, archive): (usize, &PathBuf)| {
        let place = workshop.path().join(number.to_string());
        let found = check_signature(study, &lab, archive, &place);
        let _ = std::fs::remove_dir_all(place);
        found
    };
    Ok(archives.iter().enumerate().filter_map(inspect).collect())
}

fn is_archive(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    path.is_file() && is_archive_name(&name)
}

fn check_signature(study: &Study, lab: &LabPublicKey, archive: &Path, place: &Path) -> Option<AuditFinding> {
    let finding = |kind, run: &str, participant, words| {
        let (run, at) = (run.to_owned(), String::new());
        AuditFinding { kind, run, participant, line: None, at, words }
    };
    let unpacked = std::fs::create_dir(place)
        .map_err(RunError::io(place))
        .and_then(|()| import_run(place, archive, None));
    let (seal, signer, _) = match unpacked {
        Ok(unpacked) => unpacked,
        // The run ID of an unreadable archive is unknown.
        Err(problem) => return Some(finding(FindingKind::Damaged, "?", None, problem.to_string())),
    };
    let manifest = Manifest::read(&place.join(&seal.run)).ok()?;
    manifest.study.as_ref().filter(|stamp| stamp.digest == study.digest)?;
    if signer.as_ref() == Some(lab) {
        return None;
    }
    let words = match signer {
        None => format!("{} is not signed", archive.display()),
        Some(key) => format!(
            "{} is signed with the key {}, which is not the lab's",
            archive.display(),
            key.fingerprint()
        ),
    };
    Some(finding(FindingKind::NotSigned, &seal.run, manifest.participant, words))
}
