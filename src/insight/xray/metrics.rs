//! Re-simulates the days of a run with their hidden state, for daily figures of any run that may be inspected.

use std::path::Path;
use std::sync::Arc;

use super::inspector::Inspector;
use novamind_record::error::RunError;
use novamind_record::folder::derived::manifest_of;
use novamind_record::mode::Mode;
use novamind_record::trajectory::Trajectory;
use novamind_session::{Access, DayReport, Look, REFUSED_LOOK, SealKey, Session};
use novamind_tools::Refusal;
use novamind_world::day::watch::Unwatched;

/// Opens a debug run or a finished run for inspection. Only inspections are recorded.
///
/// # Errors
/// `NotPossible` for other runs, which are not opened; as [`Session::open`].
pub fn open_to_look_inside(folder: &Path, key: SealKey) -> Result<Session, RunError> {
    let mode = manifest_of(folder)?.mode;
    if mode != Mode::Debug && Trajectory::read(&folder.join("trajectory.jsonl"))?.end().is_none() {
        return Err(RunError::NotPossible(REFUSED_LOOK.to_owned()));
    }
    let session = Session::open_sealed(folder, Access::Write, false, key)?;
    match session.refuse_to_look_inside() {
        Ok(()) => Ok(session),
        Err(refusal) => Err(RunError::NotPossible(refusal.message)),
    }
}

impl Inspector<'_> {
    /// Re-simulates every day of the run for an observer. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `not_possible`, `not_readable`, `not_saved`.
    pub fn tell_days_again(&mut self, tell: &mut dyn FnMut(&DayReport<'_>)) -> Result<(), Refusal> {
        let look = Look::begin_at(self.run, "metrics", "days", self.run.day())?;
        look.shadow(self.run, Arc::new(Unwatched))?.lead(self.run, |_| true, tell)
    }
}
