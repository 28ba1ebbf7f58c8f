//! The days of a run, simulated again beside it and watched.

use std::sync::{Arc, Mutex, PoisonError};

use super::hidden_day::{Diary, HiddenDay};
use crate::play::advance::DayReport;
use crate::state::Session;
use crate::why::not_readable;
use novamind_record::trajectory::Trajectory;
use novamind_tools::Refusal;
use novamind_world::day::watch::DayWatch;
use novamind_world::events::Facts;
use novamind_world::params::Params;
use novamind_world::state::World;

impl Session {
    /// Days that are over, as they were seen from within, the first one first.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(crate) fn hidden_days(
        &mut self,
        days: impl IntoIterator<Item = u32>,
    ) -> Result<Vec<HiddenDay>, Refusal> {
        let diary = self.diary_of_all_days(self.diary.keeps_threads())?;
        Ok(days.into_iter().filter_map(|day| diary.day(day)).collect())
    }

    /// What was seen of every day up to now, with the threads of each if they are to be kept: a shadow that was led without
    /// keeping them begins anew.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(crate) fn diary_of_all_days(&mut self, with_threads: bool) -> Result<Arc<Diary>, Refusal> {
        let kept = self.shadow.take().filter(|_| self.diary.keeps_threads() == with_threads);
        let mut shadow = match kept {
            Some(shadow) => shadow,
            None => {
                self.diary = Arc::new(if with_threads { Diary::with_threads() } else { Diary::default() });
                self.new_shadow(self.diary.clone())?
            }
        };
        // A shadow that went wrong is not kept: the next look begins anew.
        self.lead(&mut shadow, |_| true)?;
        self.shadow = Some(shadow);
        Ok(self.diary.clone())
    }

    /// The world on the evening of a day that is over.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(crate) fn world_on(&self, day: u32) -> Result<World, Refusal> {
        let evening = Arc::new(Evening { day, world: Mutex::default() });
        self.watch_up_to(day, evening.clone())?;
        let world = evening.world.lock().unwrap_or_else(PoisonError::into_inner).take();
        world.ok_or_else(|| Refusal::new("not_readable", format!("the record does not lead to day {day}")))
    }

    /// A day that is over, as it was seen from within.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(crate) fn hidden_day(&mut self, day: u32) -> Result<HiddenDay, Refusal> {
        let seen = self.hidden_days([day])?.pop();
        seen.ok_or_else(|| Refusal::new("not_readable", format!("day {day} could not be simulated again")))
    }

    /// Shows somebody the days of the run up to one of them, and at most to the end of its week.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(crate) fn watch_up_to(&self, day: u32, watch: Arc<dyn DayWatch>) -> Result<(), Refusal> {
        let mut shadow = self.new_shadow(watch)?;
        self.lead(&mut shadow, |shadow| shadow.day() < day)
    }

    /// This run again, before its first line and watched.
    ///
    /// # Errors
    /// `not_possible`: the run has no folder; `not_readable`.
    pub(crate) fn new_shadow(&self, watch: Arc<dyn DayWatch>) -> Result<Box<Session>, Refusal> {
        if self.folder.is_none() {
            let message = "a run in memory keeps no lines, so its past days cannot be simulated again";
            return Err(Refusal::new("not_possible", message));
        }
        let params = Arc::new(self.manifest.params().map_err(|error| not_readable(&error))?);
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
    pub(crate) fn lead_telling(
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
        let trajectory = Trajectory::read(&path).map_err(|error| not_readable(&error))?;
        let lines = trajectory.lines.iter().skip_while(|line| has_begun && line.seq <= shadow.position.seq);
        let lacking: Vec<_> = lines.take_while(|line| line.seq <= self.position.seq).collect();
        for line in lacking {
            if !goes_on(shadow) {
                break;
            }
            shadow.apply_line_telling(&path, line, tell).map_err(|error| not_readable(&error))?;
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
