//! The days of a run, simulated again and told one by one with their hidden state: for figures of any run that may be looked
//! into, one that a person played included.

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

/// Opens a run to look into it: a debug run, or one that is over. Nothing but looks is recorded.
///
/// # Errors
/// `NotPossible` for any other run, which is not opened then; as [`Session::open`].
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
    /// Tells every day of the run again, with its hidden state. The look is recorded.
    ///
    /// # Errors
    /// `not_in_this_mode`, `not_possible`, `not_readable`, `not_saved`.
    pub fn tell_days_again(&mut self, tell: &mut dyn FnMut(&DayReport<'_>)) -> Result<(), Refusal> {
        let look = Look::begin_at(self.run, "metrics", "days", self.run.day())?;
        look.shadow(self.run, Arc::new(Unwatched))?.lead(self.run, |_| true, tell)
    }
}
