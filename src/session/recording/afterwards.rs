//! What is done once a run is over: `afterwards.jsonl`, lines like those of the trajectory that go on from its last.
//!
//! The end is the last line of a trajectory, so that a finished run never changes. Notes, statements that are kept, looks
//! and answers to questions come after it.

use std::path::Path;

use novamind_record::error::RunError;
use novamind_record::trajectory::{Line, Trajectory, read_regular_file};

/// Name of the file in the folder of the run.
pub(crate) const AFTERWARDS: &str = "afterwards.jsonl";

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
