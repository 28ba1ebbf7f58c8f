//! What-if: re-simulates days of a run with some decisions changed and all others kept.
//!
//! Branches have the random draws of the run, so a difference is exactly the effect of the edit. Optionally, each
//! branch is simulated with several futures. All branches have the same futures.

mod adoption;
mod comparison;
mod decision_edit;
mod decision_history;
mod figure;
mod futures;
pub(crate) mod lesson_restrictions;
#[cfg(test)]
mod lesson_tests;
mod related_runs;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

pub use adoption::{AdoptedBranch, create_branch_with_decisions};
pub use comparison::{
    BranchComparison, BranchFigures, CallDifference, ParameterDifference, RejectedDecision,
};
pub use decision_edit::{DecisionEdit, EDIT_SYNTAX, MAX_FACTOR, is_scalable, scale_numbers};
pub use decision_history::DecisionHistory;
pub use figure::BranchFigure;
pub use futures::{FutureInterval, Futures};
pub use related_runs::{BranchOrigin, FirstChange, RelatedRun, branch_origin, related_runs};

use self::decision_edit::BranchStart;
use self::lesson_restrictions::{check_tools_unlocked, lesson_state};
use crate::causes::{InputVisibility, input_visibility};
use crate::counterfactual::analysis_cache::RecordAnalysis;
use crate::counterfactual::branch::{BranchOutcome, first_different_day, simulate_branch};
use crate::counterfactual::edits::{Edits, Redraw, UsageBasedCapacity};
use crate::counterfactual::memory_snapshot::MemorySnapshot;
use crate::counterfactual::parallel_map::parallel_map;
use crate::counterfactual::recorded_run::RecordedRun;
use crate::counterfactual::recorded_steps::{RecordedDecision, RecordedStep};
use novamind_record::figures::WeekFigures;
use novamind_record::lesson::LessonProgress;
use novamind_record::mode::Mode;
use novamind_session::engine::UsageCapacityRule;
use novamind_session::{InspectionPermit, Session, unreadable_record_rejection};
use novamind_tools::{Arguments, Rejection, ToolContext, ToolId, highest_customer};
use novamind_world::events::DayFigures;

/// Maximum number of alternatives in one comparison.
pub const MAX_ALTERNATIVES: usize = 3;
/// Minimum number of simulated weeks, unless the run ends earlier.
const MIN_WEEKS: u32 = 12;
/// Number of weeks before the start of the branches that are simulated for figures over several days.
const LOOKBACK_WEEKS: u32 = 5;

/// A callback that receives the number of simulated days and the total, and can stop the simulation.
pub type WhatIfProgressFn<'a> = &'a (dyn Fn(usize, usize) -> ControlFlow<()> + Sync);

/// An analysis that compares a run with branches that have changed decisions.
pub struct WhatIf {
    folder: PathBuf,
    run: RecordedRun,
    visibility: InputVisibility,
    /// Whether the inspection is recorded, so that hidden figures may be shown.
    shows_hidden: bool,
    /// Progress in the unfinished lesson of the run; `None` if the run has no unfinished lesson.
    lesson: Option<LessonProgress>,
    /// Whether the lesson of the run changes the capacity automatically. If so, the branches also change the capacity
    /// automatically.
    automates_capacity: bool,
}

/// The state at the start of the branches, and the recorded days before and after this state.
struct BranchPoint {
    start: Arc<MemorySnapshot>,
    earlier: Vec<DayFigures>,
    steps: Vec<RecordedStep>,
    until: u32,
}

impl RecordAnalysis for WhatIf {
    /// # Errors
    /// `not_in_this_mode` for an unfinished baseline run, `not_readable`.
    fn open(folder: &Path) -> Result<WhatIf, Rejection> {
        let past = RecordedRun::open(folder).map_err(|error| unreadable_record_rejection(&error))?;
        let sight = input_visibility(&past.manifest, past.is_ended)?;
        let (lesson, changes_capacity) = lesson_state(folder, &past)?;
        Ok(WhatIf {
            folder: folder.to_owned(),
            run: past,
            visibility: sight,
            shows_hidden: false,
            lesson,
            automates_capacity: changes_capacity,
        })
    }

    fn refresh(&mut self) -> Result<(), Rejection> {
        self.run.refresh().map_err(|error| unreadable_record_rejection(&error))?;
        self.visibility = input_visibility(&self.run.manifest, self.run.is_ended)?;
        (self.lesson, self.automates_capacity) = lesson_state(&self.folder, &self.run)?;
        Ok(())
    }
}

/// Records an inspection for a what-if that shows true satisfaction. Returns `false` if the run may not be inspected
/// or the event cannot be written. The what-if then omits satisfaction.
pub fn record_what_if_inspection(run: &mut Session, week: u32) -> bool {
    let day = run.day();
    InspectionPermit::start_at_current_state(run, "whatif", &format!("from {week}"), day).is_ok()
}

impl WhatIf {
    /// Sets whether hidden figures are shown, which requires a recorded inspection.
    pub fn set_shows_hidden(&mut self, is_recorded: bool) {
        self.shows_hidden = is_recorded;
    }

    /// Rejects the what-if if the lesson waits for a guess.
    fn check_guess_submitted(&self) -> Result<(), Rejection> {
        let weeks = self.run.last_day() / self.run.days_per_week();
        self.lesson.as_ref().map_or(Ok(()), |lesson| lesson.check_guess_submitted(weeks))
    }

    /// Returns the edits of each branch after checking that the player may make them. Returns `None` if `progress`
    /// stopped the simulation.
    fn edits_for_branches(
        &mut self,
        alternatives: &[Vec<DecisionEdit>],
        branch_point: &BranchPoint,
        progress: WhatIfProgressFn<'_>,
    ) -> Result<Option<BranchEdits>, Rejection> {
        if let Some(lesson) = &self.lesson {
            alternatives.iter().try_for_each(|decision_edits| {
                check_tools_unlocked(lesson, decision_edits, &branch_point.steps)
            })?;
        }
        let (all, mut edits) = build_branch_edits(alternatives, branch_point, self.run.manifest.mode)?;
        let week_before = branch_point.week_before(self.run.days_per_week());
        for (branch_edits, decided) in edits.iter_mut().zip(&all) {
            branch_edits.week_before = week_before;
            if self.automates_capacity {
                self.apply_lesson_capacity(branch_edits, decided, branch_point);
            }
        }
        let Some(day) = branch_point.last_day_naming_new_customers(&edits) else {
            return Ok(Some((all, edits)));
        };
        let day = self.run.last_recorded_day_up_to(day);
        let snapshot = self.run.snapshot_at(day, &mut |simulated| progress(simulated as usize, day as usize));
        let Some(memory_snapshot) = snapshot.map_err(|error| unreadable_record_rejection(&error))? else {
            return Ok(None);
        };
        let meant = Arc::new(memory_snapshot.world.customers.numbers.clone());
        edits.iter_mut().for_each(|branch_edits| branch_edits.recorded_numbers = Some(meant.clone()));
        Ok(Some((all, edits)))
    }

    /// Applies the capacity rule of the lesson. The unchanged run uses the rule after the last recorded day. An edited
    /// branch uses the lesson's rule unless its edits define another rule.
    fn apply_lesson_capacity(&self, edits: &mut Edits, decided: &[DecisionEdit], branch_point: &BranchPoint) {
        let rule = UsageCapacityRule::StepByStep;
        match (decided.is_empty(), edits.capacity_rule) {
            (true, _) => {
                edits.capacity_rule = Some(UsageBasedCapacity { rule, from_day: self.run.last_day() })
            }
            (false, None) => {
                let followed = UsageBasedCapacity { rule, from_day: branch_point.start.world.day };
                decision_edit::add_usage_based_capacity(followed, edits, &branch_point.steps);
            }
            (false, Some(_)) => {}
        }
    }

    /// Returns the decisions of the run at and after the start of a week. Edits can change these decisions.
    ///
    /// # Errors
    /// `week_unknown`, and `guess_first` if the lesson waits for a guess.
    pub fn decisions(&self, week: u32) -> Result<Vec<RecordedDecision>, Rejection> {
        self.check_guess_submitted()?;
        let from = self.first_day_of_week(week)?;
        let moves = self.run.steps_between(from, self.run.manifest.days);
        // Automatic settings of a lesson are not decisions of the student.
        let sets_parameters = self.run.manifest.mode == Mode::Debug;
        let decided = moves.iter().filter_map(RecordedDecision::from_step);
        Ok(decided
            .filter(|recorded_decision| {
                sets_parameters || matches!(recorded_decision, RecordedDecision::Call(_))
            })
            .collect())
    }

    /// Returns all decisions of the run with the settings before them.
    ///
    /// # Errors
    /// `guess_first` if the lesson waits for a guess.
    pub fn history(&self) -> Result<DecisionHistory, Rejection> {
        let (decisions, days) = (self.decisions(1)?, self.run.days_per_week());
        Ok(DecisionHistory::new(decisions, self.run.initial_settings(), days))
    }

    /// Returns the rejection of each edit that a comparison from the start of a week would reject, without simulating
    /// the branch. Rejections that depend on the branch are part of the comparison. Returns `None` if `progress`
    /// stopped the simulation of the days before the week.
    ///
    /// # Errors
    /// `week_unknown`, `not_readable`, and `guess_first` if the lesson waits for a guess.
    pub fn check(
        &mut self,
        week: u32,
        decided: &[DecisionEdit],
        progress: WhatIfProgressFn<'_>,
    ) -> Result<Option<Vec<Option<Rejection>>>, Rejection> {
        self.check_guess_submitted()?;
        let from = self.first_day_of_week(week)?;
        let until = self.last_simulated_day(week, None)?;
        let mut reach = |day: u32| progress(day as usize, from as usize);
        let moment = self.run.snapshot_at(from, &mut reach);
        let Some(start) = moment.map_err(|error| unreadable_record_rejection(&error))? else {
            return Ok(None);
        };
        let moves = self.run.steps_between(from, until);
        let mut found = with_branch_start(&start, self.run.manifest.mode, |opening| {
            decision_edit::rejected_edits(decided, opening, moves, until)
        });
        if let Some(lesson) = &self.lesson {
            for (edit, refusal) in decided.iter().zip(&mut found) {
                let locked = check_tools_unlocked(lesson, std::slice::from_ref(edit), moves);
                *refusal = locked.err().or(refusal.take());
            }
        }
        Ok(Some(found))
    }

    /// Returns the result of [`WhatIf::compare`], and the result of [`WhatIf::futures`] if a number of futures is
    /// given. Returns `None` if `progress` stopped the simulation.
    ///
    /// # Errors
    /// Same errors as [`WhatIf::compare`].
    pub fn compare_with_futures(
        &mut self,
        (week, until_week): (u32, Option<u32>),
        alternatives: &[Vec<DecisionEdit>],
        futures: Option<u32>,
        progress: WhatIfProgressFn<'_>,
    ) -> Result<Option<(BranchComparison, Option<Futures>)>, Rejection> {
        let Some(branch_point) = self.branch_point(week, until_week, progress)? else { return Ok(None) };
        let Some(all) = self.edits_for_branches(alternatives, &branch_point, progress)? else {
            return Ok(None);
        };
        let Some(compared) = self.compare_branches(&branch_point, &all, progress)? else { return Ok(None) };
        let Some(count) = futures else { return Ok(Some((compared, None))) };
        let drawn = self.simulate_futures(&branch_point, &all.1, count, progress)?;
        Ok(drawn.map(|drawn| (compared, Some(drawn))))
    }

    /// Compares the unchanged run with up to three alternatives, from the start of one week to the end of another
    /// week. By default the last recorded week is the last week, but at least twelve weeks are simulated. Returns
    /// `None` if `progress` stopped the simulation.
    ///
    /// # Errors
    /// `week_unknown`, `line_unknown`, `no_effect`, `edited_twice`, the rejections of the arguments of a call,
    /// `too_many_alternatives`, `too_many_leads`, `not_readable`; in an unfinished lesson `guess_first` if the lesson
    /// waits for a guess, and `not_in_this_lesson` for an unavailable tool.
    pub fn compare(
        &mut self,
        week: u32,
        until_week: Option<u32>,
        alternatives: &[Vec<DecisionEdit>],
        progress: WhatIfProgressFn<'_>,
    ) -> Result<Option<BranchComparison>, Rejection> {
        Ok(self
            .compare_with_futures((week, until_week), alternatives, None, progress)?
            .map(|(compared, _)| compared))
    }

    fn compare_branches(
        &self,
        branch_point: &BranchPoint,
        (all, edits): &BranchEdits,
        progress: WhatIfProgressFn<'_>,
    ) -> Result<Option<BranchComparison>, Rejection> {
        let Some(outcomes) = branch_point.simulate(edits, progress)? else { return Ok(None) };
        let BranchPoint { start, earlier, steps: moves, until } = branch_point;
        let from = start.world.day;
        let mut branches = Vec::new();
        for ((decided, made), outcome) in all.iter().zip(edits).zip(&outcomes) {
            let differs_on = match latest_difference_day(&outcomes[0], outcome) {
                None => None,
                Some(last) => {
                    let mut go_on = |day: u32| progress(day as usize, last as usize);
                    let pair = (&edits[0], made);
                    let Some(day) = first_different_day(start, moves, pair, last, &mut go_on) else {
                        return Ok(None);
                    };
                    day
                }
            };
            branches.push(BranchFigures::new(decided, (made, moves, from), earlier, outcome, differs_on));
        }
        let tells_all = self.visibility == InputVisibility::EveryInput && self.shows_hidden;
        let shown = |figure: &BranchFigure| tells_all || !figure.is_hidden();
        Ok(Some(BranchComparison {
            from,
            until: *until,
            recorded_until: self.run.last_day(),
            branches,
            figures: BranchFigure::ALL.into_iter().filter(shown).collect(),
        }))
    }

    /// Simulates the branches with several futures. New random draws start after the last recorded day if the branches
    /// continue beyond it, otherwise at the start of the branches. Returns `None` if `progress` stopped the simulation.
    ///
    /// # Errors
    /// Same errors as [`WhatIf::compare`].
    pub fn futures(
        &mut self,
        week: u32,
        until_week: Option<u32>,
        alternatives: &[Vec<DecisionEdit>],
        count: u32,
        progress: WhatIfProgressFn<'_>,
    ) -> Result<Option<Futures>, Rejection> {
        let Some(branch_point) = self.branch_point(week, until_week, progress)? else { return Ok(None) };
        let Some((_, edits)) = self.edits_for_branches(alternatives, &branch_point, progress)? else {
            return Ok(None);
        };
        self.simulate_futures(&branch_point, &edits, count, progress)
    }

    fn simulate_futures(
        &self,
        branch_point: &BranchPoint,
        edits: &[Edits],
        count: u32,
        progress: WhatIfProgressFn<'_>,
    ) -> Result<Option<Futures>, Rejection> {
        let last = self.run.last_day();
        let after = if last < branch_point.until {
            last.max(branch_point.start.world.day)
        } else {
            branch_point.start.world.day
        };
        let redrawn = |edits: &Edits, salt| {
            let redrawn = Some(Redraw { after_day: after, salt });
            Edits { redraw: redrawn, ..edits.clone() }
        };
        let salts = || 0..u64::from(count);
        let drawn: Vec<Edits> = edits
            .iter()
            .flat_map(|branch_edits| salts().map(move |salt| redrawn(branch_edits, salt)))
            .collect();
        let Some(outcomes) = branch_point.simulate(&drawn, progress)? else { return Ok(None) };
        let days = branch_point.week_ends(self.run.days_per_week());
        let valued: Vec<_> =
            outcomes.iter().map(|outcome| figure::weekly_values(&branch_point.earlier, outcome)).collect();
        let branches = valued.chunks(count.max(1) as usize).map(<[_]>::to_vec).collect();
        Ok(Some(Futures::new(after, days, branches)))
    }

    /// Returns the number of days per week of the run.
    pub fn days_per_week(&self) -> u32 {
        self.run.days_per_week()
    }

    /// Returns the first decision day of a week, if the week starts at the end of a recorded day.
    fn first_day_of_week(&self, week: u32) -> Result<u32, Rejection> {
        let days = self.run.days_per_week();
        let day = week.checked_sub(1).map(|earlier| earlier.saturating_mul(days));
        let last = self.run.last_day().min(self.run.manifest.days.saturating_sub(1)) / days + 1;
        match day {
            Some(day) if week <= last && self.run.has_recorded_state_on(day) => Ok(day),
            _ => {
                let message =
                    format!("a what-if cannot start with week {week}; choose a week from 1 to {last}");
                Err(Rejection::for_field("week", "week_unknown", message))
            }
        }
    }

    /// Returns the last day that can be simulated, and whether the run or a lesson step ends on this day. In an
    /// unfinished lesson, the simulation stops at the end of the current step, because the next step can ask the
    /// student to guess the outcome.
    fn last_possible_day(&self) -> (u32, &'static str) {
        let (days, last) = (self.run.days_per_week(), self.run.manifest.days);
        let step_end = self.lesson.as_ref().and_then(|lesson| {
            let part = lesson.current_part();
            part.step_at_week(self.run.last_day() / days).map(|step| part.step_weeks(step).1 * days)
        });
        match step_end {
            Some(end) if end < last => (end, "the step of the lesson"),
            _ => (last, "the run"),
        }
    }

    /// Returns the last day of the branches.
    ///
    /// # Errors
    /// `week_unknown` if the branches cannot end with the requested week.
    fn last_simulated_day(&self, week: u32, until_week: Option<u32>) -> Result<u32, Rejection> {
        let (days, (horizon, ends)) = (self.run.days_per_week(), self.last_possible_day());
        match until_week {
            Some(last) if last > horizon.div_ceil(days) => {
                let message =
                    format!("week {last} is after the last week of {ends}, {}", horizon.div_ceil(days));
                Err(Rejection::for_field("until", "week_unknown", message))
            }
            Some(last) if last >= week => Ok(last.saturating_mul(days).min(horizon)),
            Some(last) => {
                let message = format!("a what-if from week {week} cannot end with week {last}");
                Err(Rejection::for_field("until", "week_unknown", message))
            }
            // The record can end within a week, but the figures need complete weeks.
            None => {
                let (from, last_end) = ((week - 1) * days, self.run.last_day().div_ceil(days) * days);
                Ok(last_end.max(from + MIN_WEEKS * days).min(horizon))
            }
        }
    }

    fn branch_point(
        &mut self,
        week: u32,
        until_week: Option<u32>,
        progress: WhatIfProgressFn<'_>,
    ) -> Result<Option<BranchPoint>, Rejection> {
        self.check_guess_submitted()?;
        let from = self.first_day_of_week(week)?;
        let (days, until) = (self.run.days_per_week(), self.last_simulated_day(week, until_week)?);
        let mut reach = |day: u32| progress(day as usize, from as usize);
        let back = (0..=from.saturating_sub(LOOKBACK_WEEKS * days))
            .rev()
            .find(|day| self.run.has_recorded_state_on(*day));
        let moments = back.map_or(Ok(None), |day| self.run.snapshot_at(day, &mut reach));
        let Some(back) = moments.map_err(|error| unreadable_record_rejection(&error))? else {
            return Ok(None);
        };
        let moment =
            self.run.snapshot_at(from, &mut reach).map_err(|error| unreadable_record_rejection(&error))?;
        let Some(start) = moment else { return Ok(None) };
        let way = self.run.steps_between(back.world.day, from);
        let Some(earlier) = simulate_branch(&back, way, &Edits::default(), from, &mut reach) else {
            return Ok(None);
        };
        let moves = self.run.steps_between(from, until).to_vec();
        Ok(Some(BranchPoint { start, earlier: earlier.days, steps: moves, until }))
    }
}

impl BranchPoint {
    /// Returns the last day of each simulated week.
    fn week_ends(&self, days_per_week: u32) -> Vec<u32> {
        let from = self.start.world.day;
        let weeks = (self.until - from).div_ceil(days_per_week);
        (1..=weeks).map(|week| (from + week * days_per_week).min(self.until)).collect()
    }

    /// Returns the figures of the week before the branches start, or `None` if the earlier days do not cover a complete
    /// week.
    fn week_before(&self, days_per_week: u32) -> Option<WeekFigures> {
        let from = self.earlier.len().checked_sub(days_per_week as usize)?;
        let mut week = WeekFigures::default();
        self.earlier[from..].iter().for_each(|day| week.add_day_figures(day));
        Some(week)
    }

    /// Returns the last day on which a call names a customer who arrived after the start of the branches. In a branch
    /// with more or fewer customers, such a customer has another number.
    fn last_day_naming_new_customers(&self, edits: &[Edits]) -> Option<u32> {
        let first_new = self.start.world.customers.next_customer;
        let is_met = |tool, args| highest_customer(tool, args) >= Some(first_new);
        let made = self.steps.iter().filter_map(|step| match step {
            RecordedStep::Call(call) => Some(call),
            RecordedStep::Parameter(_) | RecordedStep::Days(_) => None,
        });
        let kept = made.clone().filter(|call| is_met(call.tool, &call.args)).map(|call| call.day);
        let changed = made.filter(|call| {
            let mut other =
                edits.iter().filter_map(|branch_edits| branch_edits.changed_arguments.get(&call.seq));
            other.any(|args| is_met(call.tool, args))
        });
        let added = edits
            .iter()
            .flat_map(|branch_edits| &branch_edits.added_calls)
            .filter(|call| is_met(call.tool, &call.args));
        kept.chain(changed.map(|call| call.day)).chain(added.map(|call| call.day)).max()
    }

    /// Simulates the days once for each element of `edits`. Returns `None` if `progress` stopped the simulation.
    ///
    /// # Errors
    /// `too_many_leads` if a day of a branch exceeds the limits of memory.
    fn simulate(
        &self,
        edits: &[Edits],
        progress: WhatIfProgressFn<'_>,
    ) -> Result<Option<Vec<BranchOutcome>>, Rejection> {
        let days = (self.until - self.start.world.day) as usize * edits.len();
        let done = AtomicUsize::new(0);
        let outcomes = parallel_map(edits, |branch_edits, stopped| {
            let mut go_on = |_| {
                let day = done.fetch_add(1, Ordering::Relaxed) + 1;
                match progress(day, days).is_break() || stopped.is_set() {
                    true => ControlFlow::Break(()),
                    false => ControlFlow::Continue(()),
                }
            };
            simulate_branch(&self.start, &self.steps, branch_edits, self.until, &mut go_on)
        });
        match outcomes.iter().flatten().find_map(|outcome| outcome.lead_overflow.clone()) {
            Some(Rejection { code, message, .. }) => {
                Err(Rejection::new(code, format!("in one of the branches {message}")))
            }
            None => Ok(outcomes),
        }
    }
}

/// Returns an upper limit for the first day on which two branches differ: the first day with different figures, or the
/// last day if only the final states differ. Returns `None` if the branches are equal.
fn latest_difference_day(one: &BranchOutcome, other: &BranchOutcome) -> Option<u32> {
    let other_figures = one.days.iter().zip(&other.days).find(|(day_figures, their)| day_figures != their);
    if let Some((day, _)) = other_figures {
        return Some(day.day);
    }
    let (one, other) = (&one.final_state.world, &other.final_state.world);
    (one.day != other.day || one.part_hashes() != other.part_hashes()).then_some(one.day.max(other.day))
}

/// Decision edits of each branch, starting with the unchanged run, and the resulting edits of recorded steps.
type BranchEdits = (Vec<Vec<DecisionEdit>>, Vec<Edits>);

fn build_branch_edits(
    alternatives: &[Vec<DecisionEdit>],
    branch_point: &BranchPoint,
    mode: Mode,
) -> Result<BranchEdits, Rejection> {
    if alternatives.len() > MAX_ALTERNATIVES {
        let message = format!("a what-if compares at most {MAX_ALTERNATIVES} alternatives");
        return Err(Rejection::new("too_many_alternatives", message));
    }
    let BranchPoint { start, steps: moves, until, .. } = branch_point;
    let all: Vec<Vec<DecisionEdit>> =
        std::iter::once(Vec::new()).chain(alternatives.iter().cloned()).collect();
    let edits: Result<_, Rejection> = with_branch_start(start, mode, |opening| {
        all.iter().map(|decided| decision_edit::build_edits(decided, opening, moves, *until)).collect()
    });
    Ok((all, edits?))
}

/// Calls `work` with the company at the start of the branches.
fn with_branch_start<R>(start: &MemorySnapshot, mode: Mode, work: impl FnOnce(&BranchStart<'_>) -> R) -> R {
    let MemorySnapshot { world, params, .. } = start;
    let check_setting = |tool: ToolId, arguments: &Arguments| {
        tool.tool().plan(&ToolContext::new(world, params), arguments).map(drop)
    };
    let (day, settings) = (world.day, &world.settings);
    work(&BranchStart { day, settings, params, mode, check_setting: &check_setting })
}
