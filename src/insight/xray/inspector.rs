//! Looking inside a run: what was seen of its days is kept with it, so that the next look begins with it.

use std::sync::Arc;

use super::breakpoint::list::Breakpoints;
use super::hidden_day::{Diary, HiddenDay};
use super::hidden_tables::HiddenTables;
use novamind_session::{Look, Session, Shadow};
use novamind_tools::Refusal;

/// What those who look inside a run keep with it.
#[derive(Default)]
pub(super) struct Observations {
    /// The run again, watched from within; none before somebody looks.
    pub(super) shadow: Option<Shadow>,
    /// What was seen of its days.
    pub(super) diary: Arc<Diary>,
    /// Conditions at which it stops.
    pub(super) breakpoints: Breakpoints,
    /// The hidden tables; none before somebody asks them.
    pub(super) hidden_tables: Option<HiddenTables>,
}

/// Somebody who looks inside a run.
pub struct Inspector<'a> {
    pub(super) run: &'a mut Session,
    pub(super) own: Box<Observations>,
}

/// What can be looked into.
pub trait Inspect {
    /// Looks inside: each question is refused, or recorded before it is answered.
    fn inspect(&mut self) -> Inspector<'_>;
}

impl Inspect for Session {
    fn inspect(&mut self) -> Inspector<'_> {
        Inspector { own: self.take_companion(), run: self }
    }
}

impl Drop for Inspector<'_> {
    fn drop(&mut self) {
        self.run.keep_companion(std::mem::take(&mut self.own));
    }
}

impl Inspector<'_> {
    /// Days that are over, as they were seen from within, the first one first.
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

    /// A day that is over, as it was seen from within.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub(super) fn hidden_day(&mut self, look: &Look, day: u32) -> Result<HiddenDay, Refusal> {
        let seen = self.hidden_days(look, [day])?.pop();
        seen.ok_or_else(|| Refusal::new("not_readable", format!("day {day} could not be simulated again")))
    }

    /// What was seen of every day up to now, with the threads of each if they are to be kept: a shadow that was led without
    /// keeping them begins anew.
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
        // A shadow that went wrong is not kept: the next look begins anew.
        shadow.lead(self.run, |_| true, &mut |_| {})?;
        self.own.shadow = Some(shadow);
        Ok(self.own.diary.clone())
    }
}
