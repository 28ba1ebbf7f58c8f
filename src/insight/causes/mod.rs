//! Causes of a weekly change. The week is re-simulated without each cause, with the same random draws.
//!
//! A cause is a difference from the previous week. Causes are the settings and calls of the player, by tool, and the
//! world inputs that the company does not control. The contribution of a cause is its Shapley value. World inputs are
//! evaluated without the player's changes. The player's changes are evaluated with the recorded world inputs. The
//! contribution of a single change is therefore exactly the difference from a branch without the change. Settings and
//! market changes that continue from the previous week are causes as well (`continued.rs`). The bills that are due are
//! also causes, because different customers have their billing day in each week. The contributions of these bills are
//! computed from simulations of the two weeks without the other causes (`due_contributions.rs`). In the residual, the
//! same bills have different outcomes: customers differ, and every day has new random draws.

mod attribution;
mod cause;
mod continued;
mod due_contributions;
mod inputs;
mod question;
mod shapley;
#[cfg(test)]
mod tests;
mod visibility;
mod week_resimulation;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

pub use attribution::{CauseContribution, ChangeExplanation};
pub use cause::{Cause, CauseDetail, InputDetail};
pub use question::{WeekQuantity, WeekQuestion};

use crate::counterfactual::analysis_cache::RecordAnalysis;
use crate::counterfactual::recorded_run::RecordedRun;
use novamind_record::lesson::is_lesson_over;
use novamind_session::{InspectionPermit, Session, unreadable_record_rejection};
use novamind_tools::Rejection;
pub(crate) use visibility::{InputVisibility, input_visibility};
use week_resimulation::WeekResimulation;

/// The progress of a [`CauseAnalysis`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CauseProgress {
    /// Current day and last day of the simulation up to the explained week.
    Replaying(u32, u32),
    /// Number of weeks re-simulated so far, and the minimum number of weeks to re-simulate.
    Simulated(usize, usize),
}

/// A callback that receives the progress and can stop the analysis.
pub type CauseProgressFn<'a> = &'a (dyn Fn(CauseProgress) -> ControlFlow<()> + Sync);

/// An analysis of changes in the weekly figures of a run. Caches its simulations for later questions.
pub struct CauseAnalysis {
    run: RecordedRun,
    visibility: InputVisibility,
    last_week: Option<WeekResimulation>,
}

impl RecordAnalysis for CauseAnalysis {
    /// # Errors
    /// `not_in_this_mode` for an unfinished baseline run, `not_readable`.
    fn open(folder: &Path) -> Result<CauseAnalysis, Rejection> {
        let past = RecordedRun::open(folder).map_err(|error| unreadable_record_rejection(&error))?;
        let sight = input_visibility(&past.manifest, past.is_ended)?;
        Ok(CauseAnalysis { run: past, visibility: sight, last_week: None })
    }

    fn refresh(&mut self) -> Result<(), Rejection> {
        self.run.refresh().map_err(|error| unreadable_record_rejection(&error))?;
        let sight = input_visibility(&self.run.manifest, self.run.is_ended)?;
        if sight != self.visibility {
            (self.visibility, self.last_week) = (sight, None);
        }
        Ok(())
    }
}

impl CauseAnalysis {
    /// Explains why a figure changed in a week, by default the last completed week. Returns `None` if `progress`
    /// stopped the analysis.
    ///
    /// # Errors
    /// `not_in_this_mode` for a figure that the player may not see; `unknown_group` for a group that the player did not
    /// know; `week_unknown` for a week that has not run, the first week, and an incomplete week; `not_readable`;
    /// `no_value` if the figure has no value in one of the two weeks.
    pub fn explain(
        &mut self,
        week_question: WeekQuestion,
        progress: CauseProgressFn<'_>,
    ) -> Result<Option<ChangeExplanation>, Rejection> {
        let WeekQuestion { quantity, week } = week_question;
        visibility::check_figure_visible(quantity, self.visibility)?;
        let week = self.resolve_week(week)?;
        if self.last_week.as_ref().is_none_or(|latest| latest.week() != week) {
            let made = WeekResimulation::new(&mut self.run, self.visibility, week, progress);
            self.last_week = made.map_err(|error| unreadable_record_rejection(&error))?;
        }
        let Some(resimulation) = &mut self.last_week else { return Ok(None) };
        match quantity.group().filter(|group| {
            self.visibility == InputVisibility::MarketAsOne && !resimulation.is_group_known(*group)
        }) {
            Some(group) => Err(visibility::unknown_group_rejection(group, week)),
            None => resimulation.explain(quantity, progress),
        }
    }

    /// Returns the requested week if it can be explained; by default, the last completed week.
    fn resolve_week(&self, week: Option<u32>) -> Result<u32, Rejection> {
        let days = self.run.days_per_week();
        let last = self.run.last_day().min(self.run.manifest.days).div_ceil(days);
        let whole = |week: u32| self.run.has_recorded_state_on((week * days).min(self.run.manifest.days));
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
        Err(Rejection::for_field("week", "week_unknown", message))
    }
}

/// Prepares the answer to a question. If the figure is hidden in unfinished runs, records an inspection first. Returns
/// the run folder, which [`CauseAnalysis`] opens.
///
/// # Errors
/// `not_in_this_mode`, `not_possible`, `day_unknown`, `not_saved`.
pub fn begin_cause_analysis(run: &mut Session, week_question: &WeekQuestion) -> Result<PathBuf, Rejection> {
    let folder = cause_analysis_folder(run)?;
    record_figure_inspection(run, week_question)?;
    Ok(folder)
}

/// Records an inspection if the requested figure is hidden in unfinished runs.
///
/// # Errors
/// `not_in_this_mode`, `day_unknown`, `not_saved`.
pub fn record_figure_inspection(run: &mut Session, week_question: &WeekQuestion) -> Result<(), Rejection> {
    let WeekQuestion { quantity, week } = week_question;
    if !quantity.is_hidden() {
        return Ok(());
    }
    visibility::check_figure_visible(*quantity, session_visibility(run)?)?;
    let days = run.params().run.days_per_week;
    let day = week.map(|week| week.saturating_mul(days).min(run.day()));
    InspectionPermit::start(run, "why", &quantity.to_string(), day).map(drop)
}

fn session_visibility(run: &Session) -> Result<InputVisibility, Rejection> {
    let is_over = run.ended().is_some() && is_lesson_over(run.folder(), run.manifest());
    input_visibility(run.manifest(), is_over)
}

/// Returns the run folder, which [`CauseAnalysis`] opens.
///
/// # Errors
/// `not_in_this_mode` for an unfinished baseline run, `not_possible` for a run in memory.
pub fn cause_analysis_folder(run: &Session) -> Result<PathBuf, Rejection> {
    session_visibility(run)?;
    let missing = || Rejection::new("not_possible", "a run in memory has no record that can be re-simulated");
    run.folder().map(Path::to_owned).ok_or_else(missing)
}
