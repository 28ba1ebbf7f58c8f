//! The days of a run, simulated again beside it and watched.

use std::sync::Arc;

use super::hidden_day::{Diary, HiddenDay};
use crate::session::error::RunError;
use crate::session::play::advance::DayReport;
use crate::session::state::Session;
use crate::session::trajectory::Trajectory;
use crate::tools::Refusal;
use crate::world::day::watch::DayWatch;

impl Session {
    /// Days that are over, as they were seen from within, the first one first.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(in crate::session) fn hidden_days(
        &mut self,
        days: impl IntoIterator<Item = u32>,
    ) -> Result<Vec<HiddenDay>, Refusal> {
        let mut shadow = match self.shadow.take() {
            Some(shadow) => shadow,
            None => {
                self.diary = Arc::new(Diary::default());
                self.new_shadow(self.diary.clone())?
            }
        };
        // A shadow that went wrong is not kept: the next look begins anew.
        self.lead(&mut shadow, |_| true)?;
        self.shadow = Some(shadow);
        Ok(days.into_iter().filter_map(|day| self.diary.day(day)).collect())
    }

    /// Shows somebody the days of the run up to one of them, and at most to the end of its week.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(in crate::session) fn watch_up_to(&self, day: u32, watch: Arc<dyn DayWatch>) -> Result<(), Refusal> {
        let mut shadow = self.new_shadow(watch)?;
        self.lead(&mut shadow, |shadow| shadow.day() < day)
    }

    /// This run again, before its first line and watched.
    ///
    /// # Errors
    /// `not_possible`: the run has no folder; `not_readable`.
    pub(in crate::session) fn new_shadow(&self, watch: Arc<dyn DayWatch>) -> Result<Box<Session>, Refusal> {
        if self.folder.is_none() {
            let message = "a run in memory keeps no lines, so its past days cannot be simulated again";
            return Err(Refusal::new("not_possible", message));
        }
        let params = Arc::new(self.manifest.params().map_err(not_readable)?);
        let mut shadow = Session::unwritten(self.manifest.clone(), self.folder.clone(), params, None);
        shadow.simulation.watch = watch;
        Ok(Box::new(shadow))
    }

    /// Applies the lines to a shadow that it lacks, at most up to the one at which the run stands, while it is to go on;
    /// each has to lead to what it records.
    ///
    /// # Errors
    /// `not_readable`.
    fn lead(&self, shadow: &mut Session, goes_on: impl Fn(&Session) -> bool) -> Result<(), Refusal> {
        self.lead_telling(shadow, goes_on, &mut |_| {})
    }

    /// The same, and tells of each day.
    ///
    /// # Errors
    /// `not_readable`.
    pub(in crate::session) fn lead_telling(
        &self,
        shadow: &mut Session,
        goes_on: impl Fn(&Session) -> bool,
        tell: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<(), Refusal> {
        let Some(folder) = &self.folder else { return Ok(()) };
        let has_begun = !shadow.position.line_hash.is_empty();
        if has_begun && shadow.position == self.position {
            return Ok(());
        }
        let path = folder.join("trajectory.jsonl");
        let trajectory = Trajectory::read(&path).map_err(not_readable)?;
        let lines = trajectory.lines.iter().skip_while(|line| has_begun && line.seq <= shadow.position.seq);
        let lacking: Vec<_> = lines.take_while(|line| line.seq <= self.position.seq).collect();
        for line in lacking {
            if !goes_on(shadow) {
                break;
            }
            shadow.apply_line_telling(&path, line, tell).map_err(not_readable)?;
        }
        Ok(())
    }
}

fn not_readable(error: RunError) -> Refusal {
    Refusal::new("not_readable", error.to_string())
}
