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

/// File in the run folder with lines recorded after the end of the run. The hash chain of these lines continues the
/// trajectory.
///
/// The `end` line is the last line of a trajectory, so a finished run never changes. Notes, saved statements,
/// inspections and answers to questions can follow the end.
pub(crate) const AFTERWARDS_FILE: &str = "afterwards.jsonl";

/// The state for writing the record of a run. A read-only run has no recorder.
pub(crate) struct Recorder {
    trajectory: TrajectoryWriter,
    /// Durability of the line of an accepted call. The line is synced before the call is confirmed. In headless runs,
    /// it is synced together with the week.
    call_durability: Durability,
    /// Folder of the run; `None` for a run in memory.
    folder: Option<PathBuf>,
    afterwards: Option<TrajectoryWriter>,
    attendance: Attendance,
    _lock: Option<RunLock>,
}

impl Recorder {
    /// Creates the trajectory of a new run, in its folder or in memory, and appends the first line.
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

    /// Continues the trajectory of a run that `lock` locks.
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

    /// Returns the durability of the line of an accepted call.
    pub(crate) fn call_durability(&self) -> Durability {
        self.call_durability
    }

    /// Returns whether every call is synced before it is confirmed.
    pub(crate) fn syncs_calls(&self) -> bool {
        self.call_durability == Durability::Synced
    }

    /// Appends a line and returns the time at which it was written.
    ///
    /// # Errors
    /// The line cannot be written. After an error, the line does not exist.
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

    /// Appends a line after the end of the run to a separate file. For a run in memory, the line is discarded.
    ///
    /// # Errors
    /// The line cannot be written, or the file is damaged. After an error, the line does not exist.
    pub(crate) fn append_afterwards(
        &mut self,
        day: u32,
        record: &Record,
        durability: Durability,
    ) -> Result<String, RunError> {
        let Some(folder) = &self.folder else { return Ok(now()) };
        if self.trajectory.has_unsynced_lines() {
            // The new line contains the hash of the `end` line, which would differ if the last week had to be simulated
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

    /// Appends a line about an irrevocable action. Returns a description of the problem if the line is not saved yet.
    pub(crate) fn append_irrevocable(&mut self, day: u32, record: &Record) -> Option<String> {
        let problem = self.trajectory.append_irrevocable(day, record).err().map(|error| error.to_string());
        self.attendance.add_line(parse_nanoseconds(self.trajectory.last_at()), record);
        problem
    }

    /// Returns how the user spent the time up to the last line.
    pub(crate) fn attendance(&self) -> &Attendance {
        &self.attendance
    }

    /// Syncs all lines, including lines that could not be written before.
    pub(crate) fn sync(&mut self) -> Result<(), RunError> {
        self.trajectory.sync()?;
        self.afterwards.as_mut().map_or(Ok(()), TrajectoryWriter::sync)
    }

    /// Syncs the lines of confirmed calls, so that the database is not ahead of the trajectory on the disk.
    pub(crate) fn sync_calls(&self) -> Result<(), RunError> {
        self.trajectory.sync_written()
    }

    /// Returns the reason why no more lines can be saved, or `None` if the recorder has not detected a problem.
    pub(crate) fn loss_reason(&self) -> Option<&str> {
        self.trajectory.loss_reason()
    }

    /// Returns whether the file is still at its path and contains all lines.
    pub(crate) fn is_complete(&self) -> bool {
        self.trajectory.is_complete()
    }

    #[cfg(test)]
    pub(crate) fn set_medium(&mut self, medium: Box<dyn novamind_record::trajectory::Medium>) {
        self.trajectory.replace_medium(medium);
    }
}

/// Reads the lines after the end of a run. The hash chain of these lines continues the trajectory. The result is empty
/// if the file does not exist.
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
