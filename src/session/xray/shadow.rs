//! The days of a run, simulated again beside it and watched.

use std::sync::{Arc, Mutex, PoisonError};

use super::hidden_day::{Diary, HiddenDay};
use crate::session::error::RunError;
use crate::session::state::Session;
use crate::session::trajectory::Trajectory;
use crate::tools::Refusal;
use crate::world::day::watch::DayWatch;
use crate::world::events::Facts;
use crate::world::params::Params;
use crate::world::state::World;

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
                // Threads that were kept once are kept on.
                let keeps = self.diary.keeps_threads();
                self.diary = Arc::new(if keeps { Diary::with_threads() } else { Diary::default() });
                self.new_shadow(self.diary.clone())?
            }
        };
        // A shadow that went wrong is not kept: the next look begins anew.
        self.lead(&mut shadow, |_| true)?;
        self.shadow = Some(shadow);
        Ok(days.into_iter().filter_map(|day| self.diary.day(day)).collect())
    }

    /// The same with the threads of each day. A shadow that was led so far without keeping them begins anew.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(in crate::session) fn hidden_days_with_threads(
        &mut self,
        days: impl IntoIterator<Item = u32>,
    ) -> Result<Vec<HiddenDay>, Refusal> {
        if self.shadow.is_none() || !self.diary.keeps_threads() {
            self.diary = Arc::new(Diary::with_threads());
            self.shadow = Some(self.new_shadow(self.diary.clone())?);
        }
        self.hidden_days(days)
    }

    /// The world on the evening of a day that is over.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(in crate::session) fn world_on(&self, day: u32) -> Result<World, Refusal> {
        let evening = Arc::new(Evening { day, world: Mutex::default() });
        self.watch_up_to(day, evening.clone())?;
        let world = evening.world.lock().unwrap_or_else(PoisonError::into_inner).take();
        world.ok_or_else(|| Refusal::new("not_readable", format!("the record does not lead to day {day}")))
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
    fn new_shadow(&self, watch: Arc<dyn DayWatch>) -> Result<Box<Session>, Refusal> {
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
            shadow.apply_line(&path, line).map_err(not_readable)?;
        }
        Ok(())
    }
}

/// Keeps the world as one day leaves it.
struct Evening {
    day: u32,
    world: Mutex<Option<World>>,
}

impl DayWatch for Evening {
    fn day_over(&self, world: &World, _: &Params, _: &Facts) {
        if world.day == self.day {
            *self.world.lock().unwrap_or_else(PoisonError::into_inner) = Some(world.clone());
        }
    }
}

fn not_readable(error: RunError) -> Refusal {
    Refusal::new("not_readable", error.to_string())
}
