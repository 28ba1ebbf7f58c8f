//! Replays of a run that pass its days to an observer.

use std::sync::Arc;

use crate::company::reports::DayReport;
use crate::database::unreadable_record_rejection;
use crate::play::Session;
use novamind_record::trajectory::Trajectory;
use novamind_tools::Rejection;
use novamind_world::day::observer::DayObserver;

/// A copy of a run that replays the recorded days and passes these days to an observer.
pub struct RunReplay(Box<Session>);

impl RunReplay {
    /// Creates a replay that starts before the first line of the run.
    ///
    /// # Errors
    /// `not_possible` if the run has no folder; `not_readable` if its record cannot be read.
    pub(super) fn new(run: &Session, watch: Arc<dyn DayObserver>) -> Result<RunReplay, Rejection> {
        if run.folder().is_none() {
            let message = "a run in memory has no record, so its past days cannot be simulated again";
            return Err(Rejection::new("not_possible", message));
        }
        let shadow = Session::new_replay(run, watch).map_err(|error| unreadable_record_rejection(&error))?;
        Ok(RunReplay(Box::new(shadow)))
    }

    /// Applies lines up to the current line of the run, while `goes_on` returns true for the current day. Each line
    /// must result in the state that it records. Calls `progress` for each simulated day.
    ///
    /// # Errors
    /// The rejection `not_readable`.
    pub fn advance(
        &mut self,
        run: &Session,
        goes_on: impl Fn(u32) -> bool,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<(), Rejection> {
        let RunReplay(shadow) = self;
        let Some(folder) = run.folder() else { return Ok(()) };
        let has_begun = !shadow.position().line_hash.is_empty();
        if has_begun && shadow.position() == run.position() {
            return Ok(());
        }
        let path = folder.join("trajectory.jsonl");
        let trajectory = Trajectory::read(&path).map_err(|error| unreadable_record_rejection(&error))?;
        let lines = trajectory.lines.iter().skip_while(|line| has_begun && line.seq <= shadow.position().seq);
        let lacking: Vec<_> = lines.take_while(|line| line.seq <= run.position().seq).collect();
        for line in lacking {
            if !goes_on(shadow.day()) {
                break;
            }
            shadow
                .apply_line_with_progress(&path, line, progress)
                .map_err(|error| unreadable_record_rejection(&error))?;
        }
        Ok(())
    }
}
