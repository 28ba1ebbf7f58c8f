//! What is done once a run is over: `afterwards.jsonl`, lines like those of the trajectory that go on from its last.
//!
//! The end is the last line of a trajectory, so that a finished run never changes. Notes, statements that are kept, looks
//! and answers to questions come after it.

use std::path::Path;

use crate::state::Session;
use novamind_record::answer_book::AnswerBook;
use novamind_record::error::RunError;
use novamind_record::files::read_regular_file;
use novamind_record::trajectory::record::Outcome;
use novamind_record::trajectory::{Line, Record, Trajectory};

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

impl Session {
    /// Applies what was kept after the end of the run. A file that is damaged is told and left alone.
    pub(crate) fn replay_afterwards(&mut self, trajectory: &Trajectory) {
        self.answers = AnswerBook::of(&trajectory.lines);
        let Some(folder) = self.folder.clone().filter(|_| self.history.ended.is_some()) else { return };
        match lines_afterwards(&folder, trajectory) {
            Ok(after) => {
                self.answers = AnswerBook::of(trajectory.lines.iter().chain(&after.lines));
                after.lines.iter().for_each(|line| self.keep_again(line));
            }
            Err(problem) => self.remarks.push(format!("{problem} What was done after the end is not shown.")),
        }
    }

    /// Statements that were kept and answers to requests, and nothing else: the company is as it ended.
    fn keep_again(&mut self, line: &Line) {
        match &line.record {
            Record::Query(query) => self.remember_query(query),
            Record::Call(call) => {
                self.history.first_answers.note_call(call);
                if let Outcome::Accepted(answer) = &call.outcome {
                    let _ = self.replay_call(call, answer);
                }
            }
            _ => {}
        }
    }
}
