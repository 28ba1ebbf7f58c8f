//! Appending lines to a trajectory, with their durability.

use std::cell::RefCell;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

use super::line::{Line, line_hash, with_sum};
use super::medium::{Medium, NamedFile};
use super::record::Record;
use super::synced_file::SyncedFile;
use crate::clock::now;
use crate::error::RunError;
use crate::files::{create_folder, parent_folder, sync_folder, write_atomically};
use crate::files::{open_regular_file_for_write, read_regular_file};
use crate::trajectory::Trajectory;
use novamind_database::ProjectionPosition;

/// When a line must be on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Durability {
    /// Before the action is confirmed.
    Synced,
    /// Together with the next synced line.
    Written,
}

/// Appends lines to a trajectory.
pub struct TrajectoryWriter {
    /// The file; `None` for a run in memory.
    file: Option<RefCell<SyncedFile>>,
    path: PathBuf,
    /// Lines that could not be written yet. They are written before the next line.
    backlog: Vec<u8>,
    next_seq: u64,
    last_hash: String,
    /// Moment of the last line.
    last_at: String,
    /// Why lines are no longer saved.
    loss_reason: Option<String>,
    /// Path of the copy that was written after the file disappeared.
    saved_copy: Option<PathBuf>,
}

impl TrajectoryWriter {
    /// Returns a trajectory in memory, which keeps number and hash of the last line only.
    pub fn in_memory() -> TrajectoryWriter {
        TrajectoryWriter {
            file: None,
            path: PathBuf::new(),
            backlog: Vec::new(),
            next_seq: 0,
            last_hash: line_hash(b""),
            last_at: String::new(),
            loss_reason: None,
            saved_copy: None,
        }
    }

    /// Creates a new file and syncs its folder.
    ///
    /// # Errors
    /// The file exists, or cannot be created. The file is removed if its folder cannot be synced.
    pub fn create(path: &Path) -> Result<TrajectoryWriter, RunError> {
        let file = File::options().create_new(true).read(true).append(true).open(path);
        let file = file.and_then(NamedFile::from_open_file).map_err(RunError::io(path))?;
        sync_folder(parent_folder(path)).inspect_err(|_| drop(std::fs::remove_file(path)))?;
        let file = Some(RefCell::new(SyncedFile::new(Box::new(file), 0)));
        Ok(TrajectoryWriter { file, path: path.to_owned(), ..TrajectoryWriter::in_memory() })
    }

    /// Opens or creates a file whose lines continue the last line of another file.
    ///
    /// # Errors
    /// The file cannot be read or created, or is damaged.
    pub fn open_after(path: &Path, last: ProjectionPosition) -> Result<TrajectoryWriter, RunError> {
        match read_regular_file(path) {
            Ok(bytes) => TrajectoryWriter::resume(path, &Trajectory::from_bytes_after(path, last, &bytes)?),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let (next_seq, last_hash) = (last.seq + 1, last.line_hash);
                Ok(TrajectoryWriter { next_seq, last_hash, ..TrajectoryWriter::create(path)? })
            }
            Err(error) => Err(RunError::Io { path: path.to_owned(), error }),
        }
    }

    /// Continues a parsed file and cuts off its unconfirmed bytes. Syncs the file, because a killed program may have left
    /// unsynced lines.
    ///
    /// # Errors
    /// The file cannot be written or synced.
    pub fn resume(path: &Path, read: &Trajectory) -> Result<TrajectoryWriter, RunError> {
        let mut file = open_regular_file_for_write(path)
            .and_then(NamedFile::from_open_file)
            .map_err(RunError::io(path))?;
        file.truncate(read.length).and_then(|()| file.sync()).map_err(RunError::io(path))?;
        Ok(TrajectoryWriter {
            file: Some(RefCell::new(SyncedFile::new(Box::new(file), read.length))),
            path: path.to_owned(),
            next_seq: read.next_seq(),
            last_hash: read.last_hash(),
            last_at: read.lines.last().map(|line| line.at.clone()).unwrap_or_default(),
            ..TrajectoryWriter::in_memory()
        })
    }

    /// Returns number and hash of the last line.
    pub fn last_position(&self) -> ProjectionPosition {
        ProjectionPosition { seq: self.next_seq.saturating_sub(1), line_hash: self.last_hash.clone() }
    }

    /// Returns the moment of the last line; empty before the first.
    pub fn last_at(&self) -> &str {
        &self.last_at
    }

    /// Appends a line and returns its moment.
    ///
    /// # Errors
    /// The line cannot be written. The file is unchanged then.
    pub fn append(&mut self, day: u32, record: &Record, durability: Durability) -> Result<String, RunError> {
        self.append_fields(record.kind(), day, record.fields(), durability)
    }

    /// Appends a copy of another line's event and day.
    ///
    /// # Errors
    /// As [`TrajectoryWriter::append`].
    pub fn append_copy(&mut self, line: &Line) -> Result<(), RunError> {
        let fields = line.record_fields();
        self.append_fields(line.record.kind(), line.day, fields, Durability::Written).map(|_| ())
    }

    fn append_fields(
        &mut self,
        kind: &str,
        day: u32,
        fields: Map<String, Value>,
        durability: Durability,
    ) -> Result<String, RunError> {
        let (bytes, hash, at) = self.build_line(kind, day, fields);
        let written = self.write_bytes(&bytes, durability).map_err(|error| self.save_copy_if_replaced(error));
        if written.is_ok() {
            self.advance_position(hash, &at);
        }
        written.map(|()| at)
    }

    /// Appends a line about an irrevocable event. If it cannot be written, it stays in memory and is written before the next
    /// line.
    ///
    /// # Errors
    /// The line cannot be written yet.
    pub fn append_irrevocable(&mut self, day: u32, record: &Record) -> Result<(), RunError> {
        let (bytes, hash, at) = self.build_line(record.kind(), day, record.fields());
        let written = self.write_bytes(&bytes, Durability::Synced);
        self.advance_position(hash, &at);
        if written.is_err() {
            self.backlog.extend_from_slice(&bytes);
        }
        written.map_err(|error| self.save_copy_if_replaced(error))
    }

    /// If the file disappeared, writes a copy of all confirmed lines next to its path and adds the copy to the error.
    fn save_copy_if_replaced(&mut self, error: RunError) -> RunError {
        let RunError::FileReplaced { path, .. } = error else { return error };
        let aside = self.saved_copy.get_or_insert_with(|| copy_path(&path)).clone();
        let error = RunError::FileReplaced { saved_copy: self.write_copy(&aside).map(|()| aside), path };
        self.loss_reason = Some(error.to_string());
        error
    }

    /// Writes a copy of all confirmed lines. An earlier copy is replaced only by a complete one.
    fn write_copy(&mut self, aside: &Path) -> Result<(), String> {
        let Some(file) = &mut self.file else { return Ok(()) };
        let accepted = file.get_mut().accepted_bytes().map_err(RunError::io(&self.path));
        let written = accepted.and_then(|mut bytes| {
            bytes.extend_from_slice(&self.backlog);
            // The folder may be missing, too.
            create_folder(parent_folder(aside))?;
            write_atomically(aside, &bytes)
        });
        written.map_err(|error| match aside.exists() {
            true => format!("{error}; {} has an earlier copy", aside.display()),
            false => error.to_string(),
        })
    }

    /// Returns why lines are no longer saved, once the writer has noticed.
    pub fn loss_reason(&self) -> Option<&str> {
        self.loss_reason.as_deref()
    }

    fn advance_position(&mut self, hash: String, at: &str) {
        self.next_seq += 1;
        self.last_hash = hash;
        at.clone_into(&mut self.last_at);
    }

    fn build_line(&self, kind: &str, day: u32, fields: Map<String, Value>) -> (Vec<u8>, String, String) {
        let at = now();
        let mut line = Map::new();
        line.insert("seq".to_owned(), self.next_seq.into());
        line.insert("kind".to_owned(), kind.into());
        line.insert("day".to_owned(), day.into());
        line.insert("at".to_owned(), at.clone().into());
        line.insert("prev".to_owned(), self.last_hash.clone().into());
        debug_assert!(
            fields.keys().all(|name| !line.contains_key(name)),
            "a field has the name of a frame field: {kind}"
        );
        line.extend(fields);
        let mut bytes = with_sum(Value::Object(line).to_string().into_bytes());
        let hash = line_hash(&bytes);
        bytes.push(b'\n');
        (bytes, hash, at)
    }

    fn write_bytes(&mut self, bytes: &[u8], durability: Durability) -> Result<(), RunError> {
        let Some(file) = &mut self.file else { return Ok(()) };
        let file = file.get_mut();
        if !file.is_file_at(&self.path) {
            // Never overwrite lines of another program, and never confirm lines that the user cannot find.
            return Err(RunError::FileReplaced { path: self.path.clone(), saved_copy: Err(String::new()) });
        }
        // Waiting lines are about irrevocable events.
        let durability = if self.backlog.is_empty() { durability } else { Durability::Synced };
        file.append(&[&self.backlog, bytes].concat(), durability).map_err(RunError::io(&self.path))?;
        self.backlog.clear();
        self.loss_reason = None;
        Ok(())
    }

    /// Syncs the written lines, even while others wait in memory.
    ///
    /// # Errors
    /// The file cannot be synced.
    pub fn sync_written(&self) -> Result<(), RunError> {
        let synced = self.file.as_ref().map_or(Ok(()), |file| file.borrow_mut().sync());
        synced.map_err(RunError::io(&self.path))
    }

    /// Returns whether an accepted line is not synced yet.
    pub fn has_unsynced_lines(&self) -> bool {
        self.file.as_ref().is_some_and(|file| file.borrow().has_unsynced() || !self.backlog.is_empty())
    }

    /// Returns whether the file is still at its path and has all accepted lines.
    pub fn is_complete(&self) -> bool {
        let is_whole = |file: &SyncedFile| file.is_file_at(&self.path) && file.is_complete();
        self.backlog.is_empty() && self.file.as_ref().is_none_or(|file| is_whole(&file.borrow()))
    }

    /// Replaces the medium.
    #[cfg(any(test, feature = "test-kit"))]
    pub fn replace_medium(&mut self, medium: Box<dyn Medium>) {
        self.file.as_mut().expect("a file").get_mut().replace_medium(medium);
    }

    /// Writes and syncs all lines.
    ///
    /// # Errors
    /// The file cannot be written or synced.
    pub fn sync(&mut self) -> Result<(), RunError> {
        self.write_bytes(b"", Durability::Synced).map_err(|error| self.save_copy_if_replaced(error))
    }
}

/// Returns the path of the copy next to a trajectory.
fn copy_path(path: &Path) -> PathBuf {
    let moment: String = now().chars().take(19).filter(|letter| letter.is_ascii_alphanumeric()).collect();
    path.with_file_name(format!("trajectory-unsaved-{moment}Z.jsonl"))
}
