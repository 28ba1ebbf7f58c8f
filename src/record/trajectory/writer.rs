//! A writer that appends lines to a trajectory with a specified durability.

use std::cell::RefCell;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

use super::line::{Line, line_hash, with_checksum};
use super::medium::{Medium, NamedFile};
use super::record::Record;
use super::synced_file::SyncedFile;
use crate::clock::now;
use crate::error::RunError;
use crate::files::{create_folder, parent_folder, sync_folder, write_atomically};
use crate::files::{open_regular_file_for_write, read_regular_file};
use crate::trajectory::Trajectory;
use novamind_database::ProjectionPosition;

/// The point in time by which a line must be on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Durability {
    /// The line must be on the disk before the action is confirmed.
    Synced,
    /// The line may reach the disk together with the next synced line.
    Written,
}

/// A writer that appends lines to a trajectory.
pub struct TrajectoryWriter {
    /// Trajectory file; `None` for a run in memory.
    file: Option<RefCell<SyncedFile>>,
    path: PathBuf,
    /// Lines that could not be written yet. The backlog is written before the next line.
    backlog: Vec<u8>,
    next_seq: u64,
    last_hash: String,
    /// Time at which the last line was written, RFC 3339.
    last_at: String,
    /// Why new lines cannot be saved; `None` if they can be saved.
    loss_reason: Option<String>,
    /// Path of the copy of all confirmed lines, which is written if the file is replaced or removed.
    saved_copy: Option<PathBuf>,
}

impl TrajectoryWriter {
    /// Creates a writer for a run in memory. The writer keeps only the number, hash and time of the last line.
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

    /// Creates a new trajectory file and syncs its folder.
    ///
    /// # Errors
    /// The file exists or cannot be created. If the folder cannot be synced, the new file is removed.
    pub fn create(path: &Path) -> Result<TrajectoryWriter, RunError> {
        let file = File::options().create_new(true).read(true).append(true).open(path);
        let file = file.and_then(NamedFile::from_open_file).map_err(RunError::io(path))?;
        sync_folder(parent_folder(path)).inspect_err(|_| drop(std::fs::remove_file(path)))?;
        let file = Some(RefCell::new(SyncedFile::new(Box::new(file), 0)));
        Ok(TrajectoryWriter { file, path: path.to_owned(), ..TrajectoryWriter::in_memory() })
    }

    /// Opens or creates a file whose lines continue the hash chain of another file after the line `last`.
    ///
    /// # Errors
    /// The file cannot be read or created, or it is damaged.
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

    /// Opens the file of a parsed trajectory for writing and removes unconfirmed bytes at its end. Syncs the file,
    /// because a killed program may have left unsynced lines.
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

    /// Returns the number and hash of the last line.
    pub fn last_position(&self) -> ProjectionPosition {
        ProjectionPosition { seq: self.next_seq.saturating_sub(1), line_hash: self.last_hash.clone() }
    }

    /// Returns the time of the last line, or an empty string before the first line.
    pub fn last_at(&self) -> &str {
        &self.last_at
    }

    /// Appends a line and returns the time at which it was written.
    ///
    /// # Errors
    /// The line cannot be written. In this case, the file is unchanged.
    pub fn append(&mut self, day: u32, record: &Record, durability: Durability) -> Result<String, RunError> {
        self.append_fields(record.kind(), day, record.fields(), durability)
    }

    /// Appends a line with the event and day of another line.
    ///
    /// # Errors
    /// The same errors as [`TrajectoryWriter::append`].
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

    /// Appends a line about an irrevocable event. If the line cannot be written, it stays in memory and is written
    /// before the next line.
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

    /// If the file was replaced or removed, writes a copy of all confirmed lines next to the old path and adds the
    /// path of the copy to the error.
    fn save_copy_if_replaced(&mut self, error: RunError) -> RunError {
        let RunError::FileReplaced { path, .. } = error else { return error };
        let aside = self.saved_copy.get_or_insert_with(|| saved_copy_path(&path)).clone();
        let error = RunError::FileReplaced { saved_copy: self.write_copy(&aside).map(|()| aside), path };
        self.loss_reason = Some(error.to_string());
        error
    }

    /// Writes a copy of all confirmed lines. An earlier copy is replaced only by a complete copy.
    fn write_copy(&mut self, aside: &Path) -> Result<(), String> {
        let Some(file) = &mut self.file else { return Ok(()) };
        let accepted = file.get_mut().accepted_bytes().map_err(RunError::io(&self.path));
        let written = accepted.and_then(|mut bytes| {
            bytes.extend_from_slice(&self.backlog);
            // The folder may have been removed, too.
            create_folder(parent_folder(aside))?;
            write_atomically(aside, &bytes)
        });
        written.map_err(|error| match aside.exists() {
            true => format!("{error}; {} contains an earlier copy", aside.display()),
            false => error.to_string(),
        })
    }

    /// Returns the reason why new lines cannot be saved, or `None` if the writer has not detected a problem.
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
        let mut bytes = with_checksum(Value::Object(line).to_string().into_bytes());
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
        // Lines in the backlog are about irrevocable events and must be synced.
        let durability = if self.backlog.is_empty() { durability } else { Durability::Synced };
        file.append(&[&self.backlog, bytes].concat(), durability).map_err(RunError::io(&self.path))?;
        self.backlog.clear();
        self.loss_reason = None;
        Ok(())
    }

    /// Syncs the written lines, even while other lines are still in the backlog.
    ///
    /// # Errors
    /// The file cannot be synced.
    pub fn sync_written(&self) -> Result<(), RunError> {
        let synced = self.file.as_ref().map_or(Ok(()), |file| file.borrow_mut().sync());
        synced.map_err(RunError::io(&self.path))
    }

    /// Returns whether a power cut could lose an accepted line.
    pub fn has_unsynced_lines(&self) -> bool {
        self.file.as_ref().is_some_and(|file| file.borrow().has_unsynced() || !self.backlog.is_empty())
    }

    /// Returns whether the file is still at its path and contains all accepted lines.
    pub fn is_complete(&self) -> bool {
        let is_whole = |file: &SyncedFile| file.is_file_at(&self.path) && file.is_complete();
        self.backlog.is_empty() && self.file.as_ref().is_none_or(|file| is_whole(&file.borrow()))
    }

    /// Replaces the medium in tests.
    #[cfg(any(test, feature = "test-kit"))]
    pub fn replace_medium(&mut self, medium: Box<dyn Medium>) {
        self.file.as_mut().expect("a file").get_mut().replace_medium(medium);
    }

    /// Writes the lines in the backlog and syncs the file.
    ///
    /// # Errors
    /// The file cannot be written or synced.
    pub fn sync(&mut self) -> Result<(), RunError> {
        self.write_bytes(b"", Durability::Synced).map_err(|error| self.save_copy_if_replaced(error))
    }
}

/// Returns a path next to a trajectory, for a copy of its confirmed lines.
fn saved_copy_path(path: &Path) -> PathBuf {
    let moment: String = now().chars().take(19).filter(|letter| letter.is_ascii_alphanumeric()).collect();
    path.with_file_name(format!("trajectory-unsaved-{moment}Z.jsonl"))
}
