//! The player's notes: a file next to the trajectory, and a line for every change.
//!
//! New notes are written to a draft before their line, and replace the old file after it. Whenever the program stops,
//! one of the two files matches the last line.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::Session;
use super::open::Access;
use novamind_record::error::RunError;
use novamind_record::files::{folder_of, sync_folder};
use novamind_record::rules::FreeText;
use novamind_record::trajectory::record::Note;
use novamind_record::trajectory::{Durability, Record, Trajectory};
use novamind_tools::Refusal;

const FILE: &str = "memo.md";
const DRAFT: &str = "memo.draft";

impl Session {
    /// Returns the notes.
    ///
    /// # Errors
    /// The file exists and cannot be read.
    pub fn memo(&self) -> Result<String, RunError> {
        let Some(folder) = &self.folder else { return Ok(self.memo_in_memory.clone()) };
        let path = folder.join(FILE);
        match std::fs::read(&path) {
            Ok(bytes) => Ok(String::from_utf8_lossy(&bytes).into_owned()),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(String::new()),
            Err(error) => Err(RunError::Io { path, error }),
        }
    }

    /// Saves the notes and records the change.
    ///
    /// # Errors
    /// `not_saved`, `read_only`.
    pub fn set_memo(&mut self, text: &str) -> Result<(), Refusal> {
        if !self.log.is_written() {
            return Err(Refusal::new("read_only", "this run is open read-only"));
        }
        let not_saved = |error: RunError| Refusal::new("not_saved", error.to_string());
        match self.folder.clone() {
            None => self.memo_in_memory = text.to_owned(),
            Some(folder) => {
                let draft = folder.join(DRAFT);
                let kept = write_draft(&draft, text).and_then(|()| self.note_memo(text));
                if let Err(error) = kept {
                    let _ = std::fs::remove_file(&draft);
                    return Err(not_saved(error));
                }
                return put_in_place(&folder).map_err(not_saved);
            }
        }
        self.note_memo(text).map_err(not_saved)
    }

    fn note_memo(&mut self, text: &str) -> Result<(), RunError> {
        let kept = self.manifest.session_rules().free_text == FreeText::Kept;
        let (digest, length) = (digest(text.as_bytes()), text.len() as u64);
        let note = Note { digest, length, text: kept.then(|| text.to_owned()) };
        self.append(&Record::Note(note), Durability::Synced)?;
        Ok(())
    }

    /// Finishes an interrupted change. Adds a remark if the notes do not match the last line, but does not change
    /// them.
    pub(crate) fn check_memo(&mut self, trajectory: &Trajectory, access: Access) {
        let Some(folder) = &self.folder else { return };
        let unfinished = notes_file(folder, trajectory) == folder.join(DRAFT);
        match (access, unfinished) {
            (Access::Write, true) => drop(put_in_place(folder)),
            // The draft was never confirmed.
            (Access::Write, false) => drop(std::fs::remove_file(folder.join(DRAFT))),
            (Access::Read, true) => return,
            (Access::Read, false) => {}
        }
        // Notes changed after the end of the run have no line in the trajectory.
        let Some(kept) = last_digest(trajectory).filter(|_| self.history.ended.is_none()) else { return };
        if digest_of(&folder.join(FILE)) != Some(kept) {
            self.remarks.push(
                "memo.md differs from the notes saved last: another program changed it, or it is damaged."
                    .to_owned(),
            );
        }
    }
}

/// Returns the file with the notes of the last line: the draft, if the program stopped between the line and the file.
pub(crate) fn notes_file(folder: &Path, trajectory: &Trajectory) -> PathBuf {
    let (file, draft) = (folder.join(FILE), folder.join(DRAFT));
    let kept = last_digest(trajectory);
    let is_kept = |path: &Path| kept.is_some() && digest_of(path) == kept;
    if !is_kept(&file) && is_kept(&draft) { draft } else { file }
}

fn last_digest(trajectory: &Trajectory) -> Option<String> {
    trajectory.lines.iter().rev().find_map(|line| line.record.notes_digest().map(str::to_owned))
}

/// Returns the digest of the notes in a file. A missing file counts as empty notes.
fn digest_of(path: &Path) -> Option<String> {
    match std::fs::read(path) {
        Ok(bytes) => Some(digest(&bytes)),
        Err(error) if error.kind() == ErrorKind::NotFound => Some(digest(b"")),
        Err(_) => None,
    }
}

fn digest(notes: &[u8]) -> String {
    blake3::hash(notes).to_hex().to_string()
}

fn write_draft(draft: &Path, text: &str) -> Result<(), RunError> {
    let written = File::create(draft)
        .and_then(|mut file| file.write_all(text.as_bytes()).and_then(|()| file.sync_all()));
    written.map_err(RunError::io(draft))?;
    sync_folder(folder_of(draft))
}

fn put_in_place(folder: &Path) -> Result<(), RunError> {
    let file = folder.join(FILE);
    std::fs::rename(folder.join(DRAFT), &file).map_err(RunError::io(&file))?;
    sync_folder(folder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{NewRun, Storage};
    use novamind_record::folder::configuration::Configuration;

    fn run(runs: &Path) -> (PathBuf, Session) {
        let storage = Storage::Runs(runs.to_owned());
        let new = NewRun { storage, projection: false, days: Some(28), ..NewRun::default() };
        let session = Session::create(new, &Configuration::shipped()).expect("a run");
        (session.folder().expect("a folder").to_owned(), session)
    }

    fn opened(folder: &Path, access: Access) -> (String, Vec<String>) {
        let session = Session::open(folder, access, false).expect("it opens");
        (session.memo().expect("notes"), session.remarks().to_vec())
    }

    #[test]
    fn notes_are_as_confirmed_wherever_the_program_was_stopped() {
        let runs = tempfile::tempdir().expect("a folder");
        let (folder, mut session) = run(runs.path());
        session.set_memo("first").expect("kept");
        // The program stopped before the line.
        write_draft(&folder.join(DRAFT), "second").expect("a draft");
        drop(session);
        assert_eq!(opened(&folder, Access::Read), ("first".to_owned(), Vec::new()));
        assert_eq!(opened(&folder, Access::Write), ("first".to_owned(), Vec::new()));
        assert!(!folder.join(DRAFT).exists(), "an unconfirmed draft is removed");
        // The program stopped between the line and the file.
        let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
        write_draft(&folder.join(DRAFT), "second").expect("a draft");
        session.note_memo("second").expect("a line");
        drop(session);
        assert_eq!(opened(&folder, Access::Read).1, Vec::<String>::new());
        assert_eq!(opened(&folder, Access::Write), ("second".to_owned(), Vec::new()));
        assert!(!folder.join(DRAFT).exists());
        // Another program changed the file.
        std::fs::write(folder.join(FILE), "third").expect("written");
        let (notes, remarks) = opened(&folder, Access::Write);
        assert_eq!(notes, "third");
        assert!(remarks.iter().any(|remark| remark.contains("another program changed it")), "{remarks:?}");
    }

    #[test]
    fn notes_that_cannot_be_recorded_are_not_kept() {
        let runs = tempfile::tempdir().expect("a folder");
        let (folder, mut session) = run(runs.path());
        session.set_memo("first").expect("kept");
        std::fs::create_dir(folder.join(DRAFT)).expect("in the way");
        assert_eq!(session.set_memo("second").expect_err("no room").code, "not_saved");
        assert_eq!(session.memo().expect("notes"), "first");
    }
}
