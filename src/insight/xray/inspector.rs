//! The inspector of hidden state. Simulated days are cached with the run for the next question.

use std::sync::Arc;

use super::breakpoint::list::Breakpoints;
use super::hidden_day::{Diary, HiddenDay};
use super::hidden_tables::HiddenTables;
use novamind_session::{Look, Session, Shadow};
use novamind_tools::Refusal;

/// Cached data of inspections of a run.
#[derive(Default)]
pub(super) struct Observations {
    /// The copy that re-simulates the days; `None` before the first question.
    pub(super) shadow: Option<Shadow>,
    pub(super) diary: Arc<Diary>,
    pub(super) breakpoints: Breakpoints,
    /// The hidden tables; `None` before the first query.
    pub(super) hidden_tables: Option<HiddenTables>,
}

/// The inspector of a run's hidden state. Each question is rejected, or recorded before it is answered.
pub struct Inspector<'a> {
    pub(super) run: &'a mut Session,
    pub(super) own: Box<Observations>,
}

/// A run whose hidden state can be inspected.
pub trait Inspect {
    /// Returns an inspector of the run.
    fn inspect(&mut self) -> Inspector<'_>;
}

impl Inspect for Session {
    fn inspect(&mut self) -> Inspector<'_> {
        Inspector { own: self.companion().take(), run: self }
    }
}

impl Drop for Inspector<'_> {
    fn drop(&mut self) {
        self.run.companion().keep(std::mem::take(&mut self.own));
    }
}

impl Inspector<'_> {
    /// Returns the hidden state of completed days, in ascending order.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(super) fn hidden_days(
        &mut self,
        look: &Look,
        days: impl IntoIterator<Item = u32>,
    ) -> Result<Vec<HiddenDay>, Refusal> {
        let diary = self.diary_of_all_days(look, self.own.diary.keeps_threads())?;
        Ok(days.into_iter().filter_map(|day| diary.day(day)).collect())
    }

    /// Returns the hidden state of a completed day.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(super) fn hidden_day(&mut self, look: &Look, day: u32) -> Result<HiddenDay, Refusal> {
        let seen = self.hidden_days(look, [day])?.pop();
        seen.ok_or_else(|| Refusal::new("not_readable", format!("day {day} could not be re-simulated")))
    }

    /// Returns the hidden state of all days up to now, optionally with threads. Restarts the re-simulation if it has no
    /// threads yet.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(super) fn diary_of_all_days(
        &mut self,
        look: &Look,
        with_threads: bool,
    ) -> Result<Arc<Diary>, Refusal> {
        let kept = self.own.shadow.take().filter(|_| self.own.diary.keeps_threads() == with_threads);
        let mut shadow = match kept {
            Some(shadow) => shadow,
            None => {
                self.own.diary =
                    Arc::new(if with_threads { Diary::with_threads() } else { Diary::default() });
                look.shadow(self.run, self.own.diary.clone())?
            }
        };
        // After an error, the next inspection restarts the re-simulation.
        shadow.lead(self.run, |_| true, &mut |_| {})?;
        self.own.shadow = Some(shadow);
        Ok(self.own.diary.clone())
    }
}
