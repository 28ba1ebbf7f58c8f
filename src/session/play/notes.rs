//! The player's notes: a file next to the trajectory, and a line for every change.
//!
//! New notes are written to a draft file before their line is appended. Then the draft replaces the notes file. If the
//! program stops at any time, one of the two files matches the last line.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::Session;
use super::open::Access;
use novamind_record::error::RunError;
use novamind_record::files::{parent_folder, sync_folder};
use novamind_record::rules::FreeTextRecording;
use novamind_record::trajectory::record::Note;
use novamind_record::trajectory::{Durability, Record, Trajectory};
use novamind_tools::Rejection;

const NOTES_FILE: &str = "memo.md";
const DRAFT_FILE: &str = "memo.draft";

impl Session {
    /// Returns the player's notes.
    ///
    /// # Errors
    /// The notes file exists but cannot be read.
    pub fn notes(&self) -> Result<String, RunError> {
        let Some(folder) = &self.folder else { return Ok(self.notes_in_memory.clone()) };
        let path = folder.join(NOTES_FILE);
        match std::fs::read(&path) {
            Ok(bytes) => Ok(String::from_utf8_lossy(&bytes).into_owned()),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(String::new()),
            Err(error) => Err(RunError::Io { path, error }),
        }
    }

    /// Saves the notes and records the change.
    ///
    /// # Errors
    /// One of the rejections `not_saved`, `read_only`.
    pub fn set_notes(&mut self, text: &str) -> Result<(), Rejection> {
        if !self.log.is_written() {
            return Err(Rejection::new("read_only", "this run is open read-only"));
        }
        let not_saved = |error: RunError| Rejection::new("not_saved", error.to_string());
        match self.folder.clone() {
            None => self.notes_in_memory = text.to_owned(),
            Some(folder) => {
                let draft = folder.join(DRAFT_FILE);
                let kept = write_draft(&draft, text).and_then(|()| self.record_notes(text));
                if let Err(error) = kept {
                    let _ = std::fs::remove_file(&draft);
                    return Err(not_saved(error));
                }
                return replace_notes_file(&folder).map_err(not_saved);
            }
        }
        self.record_notes(text).map_err(not_saved)
    }

    fn record_notes(&mut self, text: &str) -> Result<(), RunError> {
        let kept = self.manifest.session_rules().free_text == FreeTextRecording::Kept;
        let (digest, length) = (notes_digest(text.as_bytes()), text.len() as u64);
        let note = Note { digest, length, text: kept.then(|| text.to_owned()) };
        self.append(&Record::Note(note), Durability::Synced)?;
        Ok(())
    }

    /// Finishes an interrupted change of the notes. If the notes do not match the last recorded change, adds a remark
    /// and does not modify the notes.
    pub(crate) fn check_notes(&mut self, trajectory: &Trajectory, access: Access) {
        let Some(folder) = &self.folder else { return };
        let unfinished = current_notes_file(folder, trajectory) == folder.join(DRAFT_FILE);
        match (access, unfinished) {
            (Access::Write, true) => drop(replace_notes_file(folder)),
            // The draft was not recorded, so the change was never confirmed.
            (Access::Write, false) => drop(std::fs::remove_file(folder.join(DRAFT_FILE))),
            (Access::Read, true) => return,
            (Access::Read, false) => {}
        }
        // Changes after the end of the run are not recorded in the trajectory.
        let Some(kept) = last_notes_digest(trajectory).filter(|_| self.history.ended.is_none()) else {
            return;
        };
        if file_digest(&folder.join(NOTES_FILE)) != Some(kept) {
            self.remarks.push(
                "memo.md differs from the last saved notes: another program changed the file, or it is damaged."
                    .to_owned(),
            );
        }
    }
}

/// Returns the file with the last recorded notes. Returns the draft file if the program stopped before replacing the
/// notes file.
pub(crate) fn current_notes_file(folder: &Path, trajectory: &Trajectory) -> PathBuf {
    let (file, draft) = (folder.join(NOTES_FILE), folder.join(DRAFT_FILE));
    let kept = last_notes_digest(trajectory);
    let is_kept = |path: &Path| kept.is_some() && file_digest(path) == kept;
    if !is_kept(&file) && is_kept(&draft) { draft } else { file }
}

fn last_notes_digest(trajectory: &Trajectory) -> Option<String> {
    trajectory.lines.iter().rev().find_map(|line| line.record.notes_digest().map(str::to_owned))
}

/// Returns the digest of the notes in a file. A missing file has the digest of empty notes.
fn file_digest(path: &Path) -> Option<String> {
    match std::fs::read(path) {
        Ok(bytes) => Some(notes_digest(&bytes)),
        Err(error) if error.kind() == ErrorKind::NotFound => Some(notes_digest(b"")),
        Err(_) => None,
    }
}

fn notes_digest(notes: &[u8]) -> String {
    blake3::hash(notes).to_hex().to_string()
}

fn write_draft(draft: &Path, text: &str) -> Result<(), RunError> {
    let written = File::create(draft)
        .and_then(|mut file| file.write_all(text.as_bytes()).and_then(|()| file.sync_all()));
    written.map_err(RunError::io(draft))?;
    sync_folder(parent_folder(draft))
}

fn replace_notes_file(folder: &Path) -> Result<(), RunError> {
    let file = folder.join(NOTES_FILE);
    std::fs::rename(folder.join(DRAFT_FILE), &file).map_err(RunError::io(&file))?;
    sync_folder(folder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{NewRun, Storage};
    use novamind_record::folder::configuration::Configuration;

    fn new_run(runs: &Path) -> (PathBuf, Session) {
        let storage = Storage::Runs(runs.to_owned());
        let new = NewRun { storage, projection: false, days: Some(28), ..NewRun::default() };
        let session = Session::create(new, &Configuration::bundled()).expect("a run");
        (session.folder().expect("a folder").to_owned(), session)
    }

    fn open_and_read_notes(folder: &Path, access: Access) -> (String, Vec<String>) {
        let session = Session::open(folder, access, false).expect("it opens");
        (session.notes().expect("notes"), session.remarks().to_vec())
    }

    #[test]
    fn notes_match_the_last_line_after_every_interruption() {
        let runs = tempfile::tempdir().expect("a folder");
        let (folder, mut session) = new_run(runs.path());
        session.set_notes("first").expect("kept");
        // The program stopped before appending the line.
        write_draft(&folder.join(DRAFT_FILE), "second").expect("a draft");
        drop(session);
        assert_eq!(open_and_read_notes(&folder, Access::Read), ("first".to_owned(), Vec::new()));
        assert_eq!(open_and_read_notes(&folder, Access::Write), ("first".to_owned(), Vec::new()));
        assert!(!folder.join(DRAFT_FILE).exists(), "an unconfirmed draft is removed");
        // The program stopped after appending the line and before replacing the file.
        let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
        write_draft(&folder.join(DRAFT_FILE), "second").expect("a draft");
        session.record_notes("second").expect("a line");
        drop(session);
        assert_eq!(open_and_read_notes(&folder, Access::Read).1, Vec::<String>::new());
        assert_eq!(open_and_read_notes(&folder, Access::Write), ("second".to_owned(), Vec::new()));
        assert!(!folder.join(DRAFT_FILE).exists());
        // Another program changed the file.
        std::fs::write(folder.join(NOTES_FILE), "third").expect("written");
        let (notes, remarks) = open_and_read_notes(&folder, Access::Write);
        assert_eq!(notes, "third");
        assert!(
            remarks.iter().any(|remark| remark.contains("another program changed the file")),
            "{remarks:?}"
        );
    }

    #[test]
    fn set_notes_keeps_old_text_if_recording_fails() {
        let runs = tempfile::tempdir().expect("a folder");
        let (folder, mut session) = new_run(runs.path());
        session.set_notes("first").expect("kept");
        std::fs::create_dir(folder.join(DRAFT_FILE)).expect("a folder at the path of the file");
        assert_eq!(session.set_notes("second").expect_err("the notes cannot be saved").code, "not_saved");
        assert_eq!(session.notes().expect("notes"), "first");
    }
}
