//! Writing a run: its trajectory, when a line has to be on the disk, and the lock that keeps other programs out.

use std::fs::File;
use std::path::{Path, PathBuf};

use crate::figures::attendance::Attendance;
use novamind_database::Position;
use novamind_record::clock::{nanoseconds, now};
use novamind_record::error::RunError;
use novamind_record::files::read_regular_file;
use novamind_record::folder::lock::lock_run;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest::start_of;
use novamind_record::trajectory::{Durability, Line, Record, Trajectory, TrajectoryWriter};

/// File in the folder of a run with what is done once it is over: lines like those of the trajectory that go on from its last.
///
/// The end is the last line of a trajectory, so that a finished run never changes. Notes, statements that are kept, looks and
/// answers to questions come after it.
pub(crate) const AFTERWARDS: &str = "afterwards.jsonl";

/// What a run has that is played, and a run that is only read has not.
pub(crate) struct Recorder {
    trajectory: TrajectoryWriter,
    /// When the line of an accepted call has to be on the disk: before the call is confirmed, or, in headless runs,
    /// with the week.
    calls: Durability,
    /// Folder of the run; none in memory.
    folder: Option<PathBuf>,
    /// What is done once the run is over, from the first line of it on.
    afterwards: Option<TrajectoryWriter>,
    /// Where the time went, line by line.
    attendance: Attendance,
    /// Held while the run may be written; none in memory.
    _lock: Option<File>,
}

impl Recorder {
    /// Begins the trajectory of a new run, in its folder or in memory, with the line that says what the run is.
    pub(crate) fn begin(
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
        let start = start_of(manifest);
        let at = trajectory.append(0, &start, Durability::Synced)?;
        let mut attendance = Attendance::default();
        attendance.note(nanoseconds(&at), &start);
        let calls = if sync_calls { Durability::Synced } else { Durability::Written };
        let folder = folder.map(Path::to_owned);
        Ok(Recorder { trajectory, calls, folder, afterwards: None, attendance, _lock: lock })
    }

    /// Goes on with the trajectory of a run whose lock is held.
    pub(crate) fn resume(path: &Path, read: &Trajectory, lock: File) -> Result<Recorder, RunError> {
        let trajectory = TrajectoryWriter::resume(path, read)?;
        let folder = path.parent().map(Path::to_owned);
        Ok(Recorder {
            trajectory,
            calls: Durability::Synced,
            folder,
            afterwards: None,
            attendance: Attendance::of(&read.lines),
            _lock: Some(lock),
        })
    }

    /// Whether a file holds the lines.
    pub(crate) fn is_on_disk(&self) -> bool {
        self.folder.is_some()
    }

    /// Number and hash of the last line.
    pub(crate) fn position(&self) -> Position {
        self.trajectory.position()
    }

    /// When the line of an accepted call has to be on the disk.
    pub(crate) fn durability_of_calls(&self) -> Durability {
        self.calls
    }

    /// Whether every call is on the disk before it is confirmed.
    pub(crate) fn syncs_calls(&self) -> bool {
        self.calls == Durability::Synced
    }

    /// Appends a line and returns the moment it carries.
    ///
    /// # Errors
    /// The disk refuses: then the line does not exist.
    pub(crate) fn append(
        &mut self,
        day: u32,
        record: &Record,
        durability: Durability,
    ) -> Result<String, RunError> {
        let at = self.trajectory.append(day, record, durability)?;
        self.attendance.note(nanoseconds(&at), record);
        Ok(at)
    }

    /// Appends a line about something that is done once the run is over, to a separate file. In memory it is not kept.
    ///
    /// # Errors
    /// The disk refuses, or the file is damaged: then the line does not exist.
    pub(crate) fn append_afterwards(
        &mut self,
        day: u32,
        record: &Record,
        durability: Durability,
    ) -> Result<String, RunError> {
        let Some(folder) = &self.folder else { return Ok(now()) };
        if self.trajectory.has_unsynced_lines() {
            // The line names the hash of the end, which would be another one if the last week had to be simulated again.
            self.trajectory.sync()?;
        }
        if self.afterwards.is_none() {
            let path = folder.join(AFTERWARDS);
            self.afterwards = Some(TrajectoryWriter::open_after(&path, self.trajectory.position())?);
        }
        let Some(writer) = &mut self.afterwards else { return Ok(now()) };
        writer.append(day, record, durability)
    }

    /// Appends a line about something that cannot be taken back. Returns what keeps it from the disk for now.
    pub(crate) fn append_done(&mut self, day: u32, record: &Record) -> Option<String> {
        let problem = self.trajectory.append_done(day, record).err().map(|error| error.to_string());
        self.attendance.note(nanoseconds(self.trajectory.last_at()), record);
        problem
    }

    /// Where the time went, up to the last line.
    pub(crate) fn attendance(&self) -> &Attendance {
        &self.attendance
    }

    /// Puts everything on the disk, also lines that it has refused so far.
    pub(crate) fn sync(&mut self) -> Result<(), RunError> {
        self.trajectory.sync()?;
        self.afterwards.as_mut().map_or(Ok(()), TrajectoryWriter::sync)
    }

    /// Puts the lines of calls on the disk that are confirmed already. The database must not know more than the disk.
    pub(crate) fn sync_calls(&self) -> Result<(), RunError> {
        self.trajectory.sync_written()
    }

    /// Why nothing is saved any more, from the moment on at which that was noticed.
    pub(crate) fn loss(&self) -> Option<&str> {
        self.trajectory.loss()
    }

    /// Whether the file still stands where it is looked for, and no line waits for it.
    pub(crate) fn is_complete(&self) -> bool {
        self.trajectory.is_complete()
    }

    /// Puts another medium in place of the file.
    #[cfg(test)]
    pub(crate) fn write_to(&mut self, medium: Box<dyn novamind_record::trajectory::Medium>) {
        self.trajectory.write_to(medium);
    }
}

/// Lines after the end of a run; none if nothing was done. They go on from the last line of the trajectory.
///
/// # Errors
/// The file cannot be read, or is damaged.
pub fn lines_afterwards(folder: &Path, trajectory: &Trajectory) -> Result<Trajectory, RunError> {
    let path = folder.join(AFTERWARDS);
    let last = trajectory.lines.last().map(Line::position);
    match (read_regular_file(&path), last) {
        (Ok(bytes), Some(last)) => Trajectory::of_file_after(&path, last, &bytes),
        (Ok(_), None) => Ok(Trajectory::default()),
        (Err(error), _) if error.kind() == std::io::ErrorKind::NotFound => Ok(Trajectory::default()),
        (Err(error), _) => Err(RunError::Io { path, error }),
    }
}
