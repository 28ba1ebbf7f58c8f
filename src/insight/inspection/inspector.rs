//! The inspector, which reads hidden state. Simulated days are cached with the run for later inspections.

use std::sync::Arc;

use super::breakpoint::list::Breakpoints;
use super::hidden_day::{HiddenDay, HiddenDayRecorder};
use super::hidden_tables::HiddenTables;
use novamind_session::{InspectionPermit, RunReplay, Session};
use novamind_tools::Rejection;

/// Cached data for the inspections of a run.
#[derive(Default)]
pub(super) struct InspectorCache {
    /// The copy of the run that re-simulates its days; `None` before the first inspection.
    pub(super) replay: Option<RunReplay>,
    pub(super) hidden_days: Arc<HiddenDayRecorder>,
    pub(super) breakpoints: Breakpoints,
    /// The hidden tables; `None` before the first query.
    pub(super) hidden_tables: Option<HiddenTables>,
}

/// The inspector of a run's hidden state. Each inspection is rejected, or is recorded before its result is returned.
pub struct Inspector<'a> {
    pub(super) run: &'a mut Session,
    pub(super) cache: Box<InspectorCache>,
}

/// A run whose hidden state can be inspected.
pub trait Inspect {
    /// Returns an inspector of the run.
    fn inspect(&mut self) -> Inspector<'_>;
}

impl Inspect for Session {
    fn inspect(&mut self) -> Inspector<'_> {
        Inspector { cache: self.extension().take(), run: self }
    }
}

impl Drop for Inspector<'_> {
    fn drop(&mut self) {
        self.run.extension().store(std::mem::take(&mut self.cache));
    }
}

impl Inspector<'_> {
    /// Returns the hidden state of completed days, in ascending order.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(super) fn hidden_days(
        &mut self,
        permit: &InspectionPermit,
        days: impl IntoIterator<Item = u32>,
    ) -> Result<Vec<HiddenDay>, Rejection> {
        let recorder = self.all_hidden_days(permit, self.cache.hidden_days.records_threads())?;
        Ok(days.into_iter().filter_map(|day| recorder.day(day)).collect())
    }

    /// Returns the hidden state of a completed day.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(super) fn hidden_day(&mut self, permit: &InspectionPermit, day: u32) -> Result<HiddenDay, Rejection> {
        let seen = self.hidden_days(permit, [day])?.pop();
        seen.ok_or_else(|| Rejection::new("not_readable", format!("day {day} could not be re-simulated")))
    }

    /// Returns the hidden state of all days up to now, optionally with threads. Restarts the re-simulation if threads
    /// are requested and were not recorded.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(super) fn all_hidden_days(
        &mut self,
        permit: &InspectionPermit,
        with_threads: bool,
    ) -> Result<Arc<HiddenDayRecorder>, Rejection> {
        let kept =
            self.cache.replay.take().filter(|_| self.cache.hidden_days.records_threads() == with_threads);
        let mut run_replay = match kept {
            Some(run_replay) => run_replay,
            None => {
                self.cache.hidden_days = Arc::new(if with_threads {
                    HiddenDayRecorder::with_threads()
                } else {
                    HiddenDayRecorder::default()
                });
                permit.replay(self.run, self.cache.hidden_days.clone())?
            }
        };
        // The copy is removed from the cache first, so that the next inspection restarts the re-simulation after an
        // error.
        run_replay.advance(self.run, |_| true, &mut |_| {})?;
        self.cache.replay = Some(run_replay);
        Ok(self.cache.hidden_days.clone())
    }
}
