//! The recorder of a run: its trajectory, the durability of lines, and the lock against other programs.

use std::path::{Path, PathBuf};

use crate::figures::attendance::Attendance;
use novamind_database::ProjectionPosition;
use novamind_record::clock::{now, parse_nanoseconds};
use novamind_record::error::RunError;
use novamind_record::files::read_regular_file;
use novamind_record::folder::lock::{RunLock, lock_run};
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest::to_start_record;
use novamind_record::trajectory::{Durability, Line, Record, Trajectory, TrajectoryWriter};

/// File in the run folder with lines recorded after the end of the run. Their hash chain continues the trajectory.
///
/// The end is the last line of a trajectory, so a finished run never changes. Notes, saved statements, inspections
/// and answers to questions can follow it.
pub(crate) const AFTERWARDS_FILE: &str = "afterwards.jsonl";

/// The parts of a played run that a read-only run does not have.
pub(crate) struct Recorder {
    trajectory: TrajectoryWriter,
    /// Durability of an accepted call's line: synced before the call is confirmed, or, in headless runs, with the
    /// week.
    call_durability: Durability,
    /// Folder of the run; `None` in memory.
    folder: Option<PathBuf>,
    afterwards: Option<TrajectoryWriter>,
    attendance: Attendance,
    _lock: Option<RunLock>,
}

impl Recorder {
    /// Creates the trajectory of a new run, in its folder or in memory, with its first line.
    pub(crate) fn create(
        manifest: &Manifest,
        folder: Option<&Path>,
        sync_calls: bool,
    ) -> Result<Recorder, RunError> {
        let (mut trajectory, lock) = match folder {
            None => (TrajectoryWriter::in_memory(), None),
            Some(folder) => {
                let lock = lock_run(folder, &manifest.id)?;
                manifest.write(folder)?;
                let trajectory = TrajectoryWriter::create(&folder.join("trajectory.jsonl"))?;
                (trajectory, Some(lock))
            }
        };
        let start = to_start_record(manifest);
        let at = trajectory.append(0, &start, Durability::Synced)?;
        let mut attendance = Attendance::default();
        attendance.add_line(parse_nanoseconds(&at), &start);
        let calls = if sync_calls { Durability::Synced } else { Durability::Written };
        let folder = folder.map(Path::to_owned);
        Ok(Recorder { trajectory, call_durability: calls, folder, afterwards: None, attendance, _lock: lock })
    }

    /// Continues the trajectory of a run whose lock is held.
    pub(crate) fn resume(path: &Path, read: &Trajectory, lock: RunLock) -> Result<Recorder, RunError> {
        let trajectory = TrajectoryWriter::resume(path, read)?;
        let folder = path.parent().map(Path::to_owned);
        Ok(Recorder {
            trajectory,
            call_durability: Durability::Synced,
            folder,
            afterwards: None,
            attendance: Attendance::from_lines(&read.lines),
            _lock: Some(lock),
        })
    }

    pub(crate) fn is_on_disk(&self) -> bool {
        self.folder.is_some()
    }

    pub(crate) fn position(&self) -> ProjectionPosition {
        self.trajectory.last_position()
    }

    /// Returns the durability of an accepted call's line.
    pub(crate) fn call_durability(&self) -> Durability {
        self.call_durability
    }

    /// Returns whether every call is synced before it is confirmed.
    pub(crate) fn syncs_calls(&self) -> bool {
        self.call_durability == Durability::Synced
    }

    /// Appends a line and returns its time.
    ///
    /// # Errors
    /// The disk fails; then the line does not exist.
    pub(crate) fn append(
        &mut self,
        day: u32,
        record: &Record,
        durability: Durability,
    ) -> Result<String, RunError> {
        let at = self.trajectory.append(day, record, durability)?;
        self.attendance.add_line(parse_nanoseconds(&at), record);
        Ok(at)
    }

    /// Appends a line after the end of the run, to a separate file. In memory the line is not kept.
    ///
    /// # Errors
    /// The disk fails, or the file is damaged; then the line does not exist.
    pub(crate) fn append_afterwards(
        &mut self,
        day: u32,
        record: &Record,
        durability: Durability,
    ) -> Result<String, RunError> {
        let Some(folder) = &self.folder else { return Ok(now()) };
        if self.trajectory.has_unsynced_lines() {
            // The new line contains the hash of the end, which would differ if the last week had to be simulated
            // again.
            self.trajectory.sync()?;
        }
        if self.afterwards.is_none() {
            let path = folder.join(AFTERWARDS_FILE);
            self.afterwards = Some(TrajectoryWriter::open_after(&path, self.trajectory.last_position())?);
        }
        let Some(writer) = &mut self.afterwards else { return Ok(now()) };
        writer.append(day, record, durability)
    }

    /// Appends a line about an irrevocable action. Returns the problem if it is not saved yet.
    pub(crate) fn append_irrevocable(&mut self, day: u32, record: &Record) -> Option<String> {
        let problem = self.trajectory.append_irrevocable(day, record).err().map(|error| error.to_string());
        self.attendance.add_line(parse_nanoseconds(self.trajectory.last_at()), record);
        problem
    }

    /// Returns the time by kind, up to the last line.
    pub(crate) fn attendance(&self) -> &Attendance {
        &self.attendance
    }

    /// Syncs all lines, including those that could not be written before.
    pub(crate) fn sync(&mut self) -> Result<(), RunError> {
        self.trajectory.sync()?;
        self.afterwards.as_mut().map_or(Ok(()), TrajectoryWriter::sync)
    }

    /// Syncs the lines of confirmed calls. The database must not be ahead of the disk.
    pub(crate) fn sync_calls(&self) -> Result<(), RunError> {
        self.trajectory.sync_written()
    }

    /// Returns why nothing more can be saved, once this was detected.
    pub(crate) fn loss_reason(&self) -> Option<&str> {
        self.trajectory.loss_reason()
    }

    /// Returns whether the file is still in its place and no line is pending.
    pub(crate) fn is_complete(&self) -> bool {
        self.trajectory.is_complete()
    }

    #[cfg(test)]
    pub(crate) fn set_medium(&mut self, medium: Box<dyn novamind_record::trajectory::Medium>) {
        self.trajectory.replace_medium(medium);
    }
}

/// Reads the lines after the end of a run; empty if there are none. Their hash chain continues the trajectory.
///
/// # Errors
/// The file cannot be read, or is damaged.
pub fn read_afterwards(folder: &Path, trajectory: &Trajectory) -> Result<Trajectory, RunError> {
    let path = folder.join(AFTERWARDS_FILE);
    let last = trajectory.lines.last().map(Line::position);
    match (read_regular_file(&path), last) {
        (Ok(bytes), Some(last)) => Trajectory::from_bytes_after(&path, last, &bytes),
        (Ok(_), None) => Ok(Trajectory::default()),
        (Err(error), _) if error.kind() == std::io::ErrorKind::NotFound => Ok(Trajectory::default()),
        (Err(error), _) => Err(RunError::Io { path, error }),
    }
}
