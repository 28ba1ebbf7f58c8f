//! Causes of a weekly change: re-simulates the week without each cause, with the same random draws.
//!
//! A cause is a difference from the week before: settings and calls of the player, by tool, and world inputs that the company does
//! not control. The contribution of a cause is its Shapley value. Inputs are evaluated without the player's changes, and the
//! player's changes in the recorded world. Therefore a single change contributes exactly the difference to a branch without it.
//! The residual is composition and chance: other customers have their billing day, and every day has new random draws.

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

/// The progress of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhyProgress {
    /// Simulating days up to the week: the current day, and the last one.
    Reaching(u32, u32),
    /// Number of re-simulated weeks, and the minimum total.
    Simulated(usize, usize),
}

/// Receives the progress. Can stop the work.
pub type OnProgress<'a> = &'a (dyn Fn(WhyProgress) -> ControlFlow<()> + Sync);

/// Explains changes of weekly figures of a run. Caches simulations for the next question.
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
    /// Explains why a figure changed in a week, by default the last completed one. Returns `None` if stopped.
    ///
    /// # Errors
    /// `not_in_this_mode` for a figure that the player may not see; `unknown_group` for a group that the player did not know;
    /// `week_unknown` for a week that has not run, the first week, and an incomplete week; `not_readable`; `no_value` if the figure
    /// has no value in one of the two weeks.
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

    /// Returns the number of a week that can be explained.
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
            0 | 1 => "why compares a week with the week before. Run two weeks first".to_owned(),
            last => {
                format!(
                    "week {asked} cannot be compared with the week before; choose a week from 2 to {last}"
                )
            }
        };
        Err(Refusal::at("week", "week_unknown", message))
    }
}

/// Prepares a question. Records an inspection first if the figure is hidden in unfinished runs. Returns the folder for
/// [`Causes::read`].
///
/// # Errors
/// `not_in_this_mode`, `not_possible`, `day_unknown`, `not_saved`.
pub fn begin_why(run: &mut Session, asked: &WeekQuestion) -> Result<PathBuf, Refusal> {
    let folder = folder_of_causes(run)?;
    look_at_figure(run, asked)?;
    Ok(folder)
}

/// Records an inspection if the figure is hidden in unfinished runs.
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

/// Returns the folder of this run for [`Causes::read`].
///
/// # Errors
/// `not_in_this_mode` for an unfinished baseline run, `not_possible` for a run in memory.
pub fn folder_of_causes(run: &Session) -> Result<PathBuf, Refusal> {
    own_sight(run)?;
    let missing = || Refusal::new("not_possible", "a run in memory has no record that can be re-simulated");
    run.folder().map(Path::to_owned).ok_or_else(missing)
}
