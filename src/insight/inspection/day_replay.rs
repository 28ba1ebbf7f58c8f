//! Re-simulation of all days of a run with their hidden state, for daily figures. The run must permit inspections.

use std::path::Path;
use std::sync::Arc;

use super::inspector::Inspector;
use novamind_record::error::RunError;
use novamind_record::folder::manifest_check::read_manifest;
use novamind_record::mode::Mode;
use novamind_record::trajectory::Trajectory;
use novamind_session::{Access, DayReport, INSPECTION_REJECTED, InspectionPermit, SealKey, Session};
use novamind_tools::Rejection;
use novamind_world::day::observer::NoObserver;

/// Opens a debug run or a finished run for inspection. The only events added to its trajectory are inspections.
///
/// # Errors
/// `InvalidRequest` for other runs, which are not opened; same errors as [`Session::open`].
pub fn open_for_inspection(folder: &Path, key: SealKey) -> Result<Session, RunError> {
    let mode = read_manifest(folder)?.mode;
    if mode != Mode::Debug && Trajectory::read(&folder.join("trajectory.jsonl"))?.end_line().is_none() {
        return Err(RunError::InvalidRequest(INSPECTION_REJECTED.to_owned()));
    }
    let session = Session::open_sealed(folder, Access::Write, false, key)?;
    match session.check_inspection() {
        Ok(()) => Ok(session),
        Err(rejection) => Err(RunError::InvalidRequest(rejection.message)),
    }
}

impl Inspector<'_> {
    /// Re-simulates every day of the run and calls `report_day` with each day. Records the inspection in the trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `not_possible`, `not_readable`, `not_saved`.
    pub fn replay_days(&mut self, report_day: &mut dyn FnMut(&DayReport<'_>)) -> Result<(), Rejection> {
        let permit = InspectionPermit::start_at_current_state(self.run, "metrics", "days", self.run.day())?;
        permit.replay(self.run, Arc::new(NoObserver))?.advance(self.run, |_| true, report_day)
    }
}
