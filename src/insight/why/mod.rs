//! Why a figure of a week changed: the week is simulated again with each of its causes taken away, under the same luck.
//!
//! A cause is something that differs from the week before: settings and calls of the player, by tool, and inputs of the world
//! that nobody in the company controls. What a cause contributes is its Shapley value. Inputs are valued with the player's
//! changes undone, and the player's changes in the world as it was; so a single change is worth exactly what a branch without
//! it lacks. What no cause explains is composition and chance: other customers are due, and luck is drawn anew every day.

mod access;
mod cause;
mod inputs;
mod laboratory;
mod quantity;
mod shapley;
#[cfg(test)]
mod tests;
mod week;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

pub use cause::{Cause, Detail, InputDetail};
pub use quantity::{WeekQuantity, WeekQuestion};
pub use week::{Why, WhyPart};

use crate::counterfactual::last_read::OfRecord;
use crate::counterfactual::past::Past;
pub(crate) use access::{Sight, sight};
use laboratory::Laboratory;
use novamind_record::lesson::is_lesson_over;
use novamind_session::{Look, Session, not_readable};
use novamind_tools::Refusal;

/// How far an answer has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhyProgress {
    /// Days are simulated up to the week: the day reached, and the last one.
    Reaching(u32, u32),
    /// Weeks that were simulated again, and how many there will be at least.
    Simulated(usize, usize),
}

/// What is told of progress; it can stop the work.
pub type OnProgress<'a> = &'a (dyn Fn(WhyProgress) -> ControlFlow<()> + Sync);

/// Answers why figures of the weeks of a run changed. It keeps what it has simulated for the next question.
pub struct Causes {
    past: Past,
    sight: Sight,
    latest: Option<Laboratory>,
}

impl OfRecord for Causes {
    /// # Errors
    /// `not_in_this_mode` for an unfinished baseline run, `not_readable`.
    fn read(folder: &Path) -> Result<Causes, Refusal> {
        let past = Past::read(folder).map_err(|error| not_readable(&error))?;
        let sight = sight(&past.manifest, past.ended)?;
        Ok(Causes { past, sight, latest: None })
    }

    fn renew(&mut self) -> Result<(), Refusal> {
        self.past.renew().map_err(|error| not_readable(&error))?;
        let sight = sight(&self.past.manifest, self.past.ended)?;
        if sight != self.sight {
            (self.sight, self.latest) = (sight, None);
        }
        Ok(())
    }
}

impl Causes {
    /// Why a figure changed in a week, the last one that ran if none is named. None if it was stopped.
    ///
    /// # Errors
    /// `not_in_this_mode` for a figure that the player may not see; `unknown_group` for a group that the player did not know;
    /// `week_unknown` for a week that has not run, the first, and one cut short; `not_readable`; `no_value` where the figure has
    /// none in one of the two weeks.
    pub fn why(&mut self, asked: WeekQuestion, progress: OnProgress<'_>) -> Result<Option<Why>, Refusal> {
        let WeekQuestion { quantity, week } = asked;
        access::refuse_hidden(quantity, self.sight)?;
        let week = self.known(week)?;
        if self.latest.as_ref().is_none_or(|latest| latest.week() != week) {
            let made = Laboratory::of(&mut self.past, self.sight, week, progress);
            self.latest = made.map_err(|error| not_readable(&error))?;
        }
        let Some(laboratory) = &mut self.latest else { return Ok(None) };
        match quantity.group().filter(|group| self.sight == Sight::Market && !laboratory.knows(*group)) {
            Some(group) => Err(access::unknown_group(group, week)),
            None => laboratory.why(quantity, progress),
        }
    }

    /// A week that can be explained.
    fn known(&self, week: Option<u32>) -> Result<u32, Refusal> {
        let days = self.past.days_per_week();
        let last = self.past.last_day().min(self.past.manifest.days).div_ceil(days);
        let whole = |week: u32| self.past.ends_on((week * days).min(self.past.manifest.days));
        let last = if whole(last) { last } else { last.saturating_sub(1) };
        let asked = week.unwrap_or(last);
        if (2..=last).contains(&asked) && whole(asked) && whole(asked - 1) {
            return Ok(asked);
        }
        let message = match last {
            0 | 1 => "why compares a week with the one before it: run two weeks first".to_owned(),
            last => {
                format!("week {asked} cannot be compared with one before it; choose a week from 2 to {last}")
            }
        };
        Err(Refusal::at("week", "week_unknown", message))
    }
}

/// Begins a question: a figure that is hidden while a run is played is shown as a look, which is recorded before anything
/// is shown. The folder from which [`Causes::read`] can answer.
///
/// # Errors
/// `not_in_this_mode`, `not_possible`, `day_unknown`, `not_saved`.
pub fn begin_why(run: &mut Session, asked: &WeekQuestion) -> Result<PathBuf, Refusal> {
    let folder = folder_of_causes(run)?;
    look_at_figure(run, asked)?;
    Ok(folder)
}

/// Records a look at a figure that is hidden while a run is played; any other is no look.
///
/// # Errors
/// `not_in_this_mode`, `day_unknown`, `not_saved`.
pub fn look_at_figure(run: &mut Session, asked: &WeekQuestion) -> Result<(), Refusal> {
    let WeekQuestion { quantity, week } = asked;
    if !quantity.is_hidden() {
        return Ok(());
    }
    access::refuse_hidden(*quantity, own_sight(run)?)?;
    let days = run.params().run.days_per_week;
    let day = week.map(|week| week.saturating_mul(days).min(run.day()));
    Look::begin(run, "why", &quantity.to_string(), day).map(drop)
}

fn own_sight(run: &Session) -> Result<Sight, Refusal> {
    let is_over = run.ended().is_some() && is_lesson_over(run.folder(), run.manifest());
    sight(run.manifest(), is_over)
}

/// The folder from which [`Causes::read`] can answer for this run.
///
/// # Errors
/// `not_in_this_mode` for an unfinished baseline run, `not_possible` for a run in memory.
pub fn folder_of_causes(run: &Session) -> Result<PathBuf, Refusal> {
    own_sight(run)?;
    let missing = || Refusal::new("not_possible", "a run in memory has no record to simulate again");
    run.folder().map(Path::to_owned).ok_or_else(missing)
}
