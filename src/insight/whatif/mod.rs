//! What-if: re-simulates days of a run with some decisions changed and all others kept.
//!
//! Branches have the random draws of the run, so a difference is exactly the effect of the edit. Futures can be redrawn as well;
//! then all branches have the same futures.

mod adopt;
mod comparison;
mod decision_edit;
mod figure;
mod futures;
mod kin;
pub(crate) mod lesson_limits;
#[cfg(test)]
mod lesson_tests;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

pub use adopt::{Adopted, branch_with_decisions};
pub use comparison::{BranchComparison, BranchFigures, DecisionDifference, ParameterDifference};
pub use decision_edit::{DecisionEdit, FORMS, sets_amounts};
pub use figure::BranchFigure;
pub use futures::{FutureBand, Futures};
pub use kin::{BranchOrigin, FirstChange, Kin, branches_of, origin_of};

use self::lesson_limits::{lesson_of, refuse_locked};
use crate::counterfactual::branch::{BranchOutcome, counterfactual, first_difference};
use crate::counterfactual::edits::{Edits, FollowedUsage, Redrawn};
use crate::counterfactual::kept_state::KeptState;
use crate::counterfactual::last_read::OfRecord;
use crate::counterfactual::one_each::one_each;
use crate::counterfactual::past::Past;
use crate::counterfactual::script::{Move, PastDecision};
use crate::why::{Sight, sight};
use novamind_record::figures::WeekFigures;
use novamind_record::lesson::LessonStanding;
use novamind_record::mode::Mode;
use novamind_session::engine::UsageRule;
use novamind_session::{Look, Session, not_readable};
use novamind_tools::{Refusal, highest_named};
use novamind_world::events::DayFigures;

/// Maximum number of alternatives in one comparison.
pub const MOST_ALTERNATIVES: usize = 3;
/// Minimum number of simulated weeks, limited by the last week of the run.
const LEAST_WEEKS: u32 = 12;
/// Weeks before the start of the branches that figures over past days use.
const WEEKS_BACK: u32 = 5;

/// Receives the number of simulated days and the total. Can stop the work.
pub type OnWhatIfProgress<'a> = &'a (dyn Fn(usize, usize) -> ControlFlow<()> + Sync);

/// Compares a run with branches in which decisions are changed.
pub struct WhatIf {
    folder: PathBuf,
    past: Past,
    sight: Sight,
    /// Whether the inspection is recorded, so that hidden figures may be shown.
    tells_hidden: bool,
    /// The unfinished lesson of the run, if any.
    lesson: Option<LessonStanding>,
    /// Whether the lesson of the run changes the capacity automatically, as in every branch.
    moves_capacity: bool,
}

/// The recorded days after the start of the branches.
struct Parting {
    start: Arc<KeptState>,
    earlier: Vec<DayFigures>,
    moves: Vec<Move>,
    until: u32,
}

impl OfRecord for WhatIf {
    /// # Errors
    /// `not_in_this_mode` for an unfinished baseline run, `not_readable`.
    fn read(folder: &Path) -> Result<WhatIf, Refusal> {
        let past = Past::read(folder).map_err(|error| not_readable(&error))?;
        let sight = sight(&past.manifest, past.ended)?;
        let (lesson, moves_capacity) = lesson_of(folder, &past)?;
        Ok(WhatIf { folder: folder.to_owned(), past, sight, tells_hidden: false, lesson, moves_capacity })
    }

    fn renew(&mut self) -> Result<(), Refusal> {
        self.past.renew().map_err(|error| not_readable(&error))?;
        self.sight = sight(&self.past.manifest, self.past.ended)?;
        (self.lesson, self.moves_capacity) = lesson_of(&self.folder, &self.past)?;
        Ok(())
    }
}

/// Records an inspection for a what-if that shows true satisfaction. Returns `false` if the run may not be inspected or the event
/// cannot be written; then the what-if omits the figure.
pub fn look_at_what_if(run: &mut Session, week: u32) -> bool {
    let day = run.day();
    Look::begin_at(run, "whatif", &format!("from {week}"), day).is_ok()
}

impl WhatIf {
    /// Sets whether hidden figures are shown, which requires a recorded inspection.
    pub fn tell_hidden(&mut self, is_recorded: bool) {
        self.tells_hidden = is_recorded;
    }

    /// Rejects the what-if while the question of a lesson is open.
    fn refuse_before_guess(&self) -> Result<(), Refusal> {
        let weeks = self.past.last_day() / self.past.days_per_week();
        self.lesson.as_ref().map_or(Ok(()), |lesson| lesson.refuse_before_guess(weeks))
    }

    /// Returns the edits of each branch after checking that the player may make them, or `None` if stopped.
    fn all_edits(
        &mut self,
        alternatives: &[Vec<DecisionEdit>],
        parting: &Parting,
        progress: OnWhatIfProgress<'_>,
    ) -> Result<Option<AllEdits>, Refusal> {
        if let Some(lesson) = &self.lesson {
            alternatives.iter().try_for_each(|own| refuse_locked(lesson, own, &parting.moves))?;
        }
        let (all, mut edits) = all_edits(alternatives, parting, self.past.manifest.mode)?;
        let week_before = parting.week_before(self.past.days_per_week());
        for (own, decided) in edits.iter_mut().zip(&all) {
            own.week_before = week_before;
            if self.moves_capacity {
                self.move_capacity_as_lesson(own, decided, parting);
            }
        }
        let Some(day) = parting.last_meeting(&edits) else { return Ok(Some((all, edits))) };
        let day = self.past.last_end(day);
        let met = self.past.moment(day, &mut |simulated| progress(simulated as usize, day as usize));
        let Some(met) = met.map_err(|error| not_readable(&error))? else { return Ok(None) };
        let meant = Arc::new(met.world.customers.numbers.clone());
        edits.iter_mut().for_each(|own| own.meant = Some(meant.clone()));
        Ok(Some((all, edits)))
    }

    /// Applies the capacity rule of the lesson: in the unchanged run after the last recorded day, and in every edited branch that
    /// has no other rule.
    fn move_capacity_as_lesson(&self, edits: &mut Edits, decided: &[DecisionEdit], parting: &Parting) {
        let rule = UsageRule::StepByStep;
        match (decided.is_empty(), edits.capacity) {
            (true, _) => edits.capacity = Some(FollowedUsage { rule, from: self.past.last_day() }),
            (false, None) => {
                let followed = FollowedUsage { rule, from: parting.start.world.day };
                decision_edit::let_capacity_follow(followed, edits, &parting.moves);
            }
            (false, Some(_)) => {}
        }
    }

    /// Returns the decisions of the run from the start of a week, which edits can change.
    ///
    /// # Errors
    /// `week_unknown`, and `guess_first` while the question of a lesson is open.
    pub fn decisions(&self, week: u32) -> Result<Vec<PastDecision>, Refusal> {
        self.refuse_before_guess()?;
        let from = self.day_of(week)?;
        let moves = self.past.between(from, self.past.manifest.days);
        // Automatic settings of a lesson are not decisions of the student.
        let sets_parameters = self.past.manifest.mode == Mode::Debug;
        let decided = moves.iter().filter_map(PastDecision::of);
        Ok(decided.filter(|own| sets_parameters || matches!(own, PastDecision::Call(_))).collect())
    }

    /// Returns the branches of [`WhatIf::compare`], and those of [`WhatIf::futures`] if a number of futures is given. Returns `None`
    /// if stopped.
    ///
    /// # Errors
    /// As for [`WhatIf::compare`].
    pub fn answer(
        &mut self,
        (week, until_week): (u32, Option<u32>),
        alternatives: &[Vec<DecisionEdit>],
        futures: Option<u32>,
        progress: OnWhatIfProgress<'_>,
    ) -> Result<Option<(BranchComparison, Option<Futures>)>, Refusal> {
        let Some(parting) = self.parting(week, until_week, progress)? else { return Ok(None) };
        let Some(all) = self.all_edits(alternatives, &parting, progress)? else { return Ok(None) };
        let Some(compared) = self.compared(&parting, &all, progress)? else { return Ok(None) };
        let Some(count) = futures else { return Ok(Some((compared, None))) };
        let drawn = self.drawn(&parting, &all.1, count, progress)?;
        Ok(drawn.map(|drawn| (compared, Some(drawn))))
    }

    /// Compares the unchanged run and up to three alternatives, from the start of a week to the end of another. By default the last
    /// week is the last recorded one, but at least twelve weeks are simulated. Returns `None` if stopped.
    ///
    /// # Errors
    /// `week_unknown`, `line_unknown`, `too_many_alternatives`, `too_many_leads`, `not_readable`; in an unfinished lesson
    /// `guess_first` while its question is open, and `not_in_this_lesson` for an unavailable tool.
    pub fn compare(
        &mut self,
        week: u32,
        until_week: Option<u32>,
        alternatives: &[Vec<DecisionEdit>],
        progress: OnWhatIfProgress<'_>,
    ) -> Result<Option<BranchComparison>, Refusal> {
        Ok(self.answer((week, until_week), alternatives, None, progress)?.map(|(compared, _)| compared))
    }

    fn compared(
        &self,
        parting: &Parting,
        (all, edits): &AllEdits,
        progress: OnWhatIfProgress<'_>,
    ) -> Result<Option<BranchComparison>, Refusal> {
        let Some(outcomes) = parting.simulate(edits, progress)? else { return Ok(None) };
        let Parting { start, earlier, moves, until } = parting;
        let from = start.world.day;
        let mut branches = Vec::new();
        for ((decided, made), outcome) in all.iter().zip(edits).zip(&outcomes) {
            let differs_on = match differs_by(&outcomes[0], outcome) {
                None => None,
                Some(last) => {
                    let mut go_on = |day: u32| progress(day as usize, last as usize);
                    let pair = (&edits[0], made);
                    let Some(day) = first_difference(start, moves, pair, last, &mut go_on) else {
                        return Ok(None);
                    };
                    day
                }
            };
            branches.push(BranchFigures::of(decided, (made, moves, from), earlier, outcome, differs_on));
        }
        let tells_all = self.sight == Sight::All && self.tells_hidden;
        let shown = |figure: &BranchFigure| tells_all || !figure.is_hidden();
        Ok(Some(BranchComparison {
            from,
            until: *until,
            recorded_until: self.past.last_day(),
            branches,
            figures: BranchFigure::ALL.into_iter().filter(shown).collect(),
        }))
    }

    /// Compares the branches with redrawn futures. Random draws are redrawn after the last recorded day if the branches continue
    /// beyond it, otherwise from the start of the branches. Returns `None` if stopped.
    ///
    /// # Errors
    /// As for [`WhatIf::compare`].
    pub fn futures(
        &mut self,
        week: u32,
        until_week: Option<u32>,
        alternatives: &[Vec<DecisionEdit>],
        count: u32,
        progress: OnWhatIfProgress<'_>,
    ) -> Result<Option<Futures>, Refusal> {
        let Some(parting) = self.parting(week, until_week, progress)? else { return Ok(None) };
        let Some((_, edits)) = self.all_edits(alternatives, &parting, progress)? else { return Ok(None) };
        self.drawn(&parting, &edits, count, progress)
    }

    fn drawn(
        &self,
        parting: &Parting,
        edits: &[Edits],
        count: u32,
        progress: OnWhatIfProgress<'_>,
    ) -> Result<Option<Futures>, Refusal> {
        let last = self.past.last_day();
        let after =
            if last < parting.until { last.max(parting.start.world.day) } else { parting.start.world.day };
        let redrawn = |edits: &Edits, salt| {
            let redrawn = Some(Redrawn { after, salt });
            Edits { redrawn, ..edits.clone() }
        };
        let salts = || 0..u64::from(count);
        let drawn: Vec<Edits> =
            edits.iter().flat_map(|own| salts().map(move |salt| redrawn(own, salt))).collect();
        let Some(outcomes) = parting.simulate(&drawn, progress)? else { return Ok(None) };
        let days = parting.week_ends(self.past.days_per_week());
        let valued: Vec<_> =
            outcomes.iter().map(|outcome| figure::values(&parting.earlier, outcome)).collect();
        let branches = valued.chunks(count.max(1) as usize).map(<[_]>::to_vec).collect();
        Ok(Some(Futures::of(after, days, branches)))
    }

    /// Returns the number of days per week of the run.
    pub fn days_per_week(&self) -> u32 {
        self.past.days_per_week()
    }

    /// Returns the day on which a week starts, if recorded days end on it.
    fn day_of(&self, week: u32) -> Result<u32, Refusal> {
        let days = self.past.days_per_week();
        let day = week.checked_sub(1).map(|earlier| earlier.saturating_mul(days));
        let last = self.past.last_day().min(self.past.manifest.days.saturating_sub(1)) / days + 1;
        match day {
            Some(day) if week <= last && self.past.ends_on(day) => Ok(day),
            _ => {
                let message =
                    format!("a what-if cannot start with week {week}; choose a week from 1 to {last}");
                Err(Refusal::at("week", "week_unknown", message))
            }
        }
    }

    /// Returns the last day that can be simulated, and a name for its end. In an unfinished lesson it is the end of the step, because
    /// the next step can ask for the outcome.
    fn horizon(&self) -> (u32, &'static str) {
        let (days, last) = (self.past.days_per_week(), self.past.manifest.days);
        let step_end = self.lesson.as_ref().and_then(|lesson| {
            let part = lesson.own_part();
            part.step_after(self.past.last_day() / days).map(|step| part.weeks_of(step).1 * days)
        });
        match step_end {
            Some(end) if end < last => (end, "the step of the lesson"),
            _ => (last, "the run"),
        }
    }

    fn parting(
        &mut self,
        week: u32,
        until_week: Option<u32>,
        progress: OnWhatIfProgress<'_>,
    ) -> Result<Option<Parting>, Refusal> {
        self.refuse_before_guess()?;
        let from = self.day_of(week)?;
        let (days, (horizon, ends)) = (self.past.days_per_week(), self.horizon());
        let until = match until_week {
            Some(last) if last > horizon.div_ceil(days) => {
                let message =
                    format!("week {last} is after the last week of {ends}, {}", horizon.div_ceil(days));
                return Err(Refusal::at("until", "week_unknown", message));
            }
            Some(last) if last >= week => last.saturating_mul(days).min(horizon),
            Some(last) => {
                let message = format!("a what-if from week {week} cannot end with week {last}");
                return Err(Refusal::at("until", "week_unknown", message));
            }
            // A record can end within a week, but figures need complete weeks.
            None => {
                let last_end = self.past.last_day().div_ceil(days) * days;
                last_end.max(from + LEAST_WEEKS * days).min(horizon)
            }
        };
        let mut reach = |day: u32| progress(day as usize, from as usize);
        let back = (0..=from.saturating_sub(WEEKS_BACK * days)).rev().find(|day| self.past.ends_on(*day));
        let moments = back.map_or(Ok(None), |day| self.past.moment(day, &mut reach));
        let Some(back) = moments.map_err(|error| not_readable(&error))? else { return Ok(None) };
        let moment = self.past.moment(from, &mut reach).map_err(|error| not_readable(&error))?;
        let Some(start) = moment else { return Ok(None) };
        let way = self.past.between(back.world.day, from);
        let Some(earlier) = counterfactual(&back, way, &Edits::default(), from, &mut reach) else {
            return Ok(None);
        };
        let moves = self.past.between(from, until).to_vec();
        Ok(Some(Parting { start, earlier: earlier.days, moves, until }))
    }
}

impl Parting {
    /// Returns the last day of each week.
    fn week_ends(&self, days_per_week: u32) -> Vec<u32> {
        let from = self.start.world.day;
        let weeks = (self.until - from).div_ceil(days_per_week);
        (1..=weeks).map(|week| (from + week * days_per_week).min(self.until)).collect()
    }

    /// Returns the usage of the week before the branches start.
    fn week_before(&self, days_per_week: u32) -> Option<WeekFigures> {
        let from = self.earlier.len().checked_sub(days_per_week as usize)?;
        let mut week = WeekFigures::default();
        self.earlier[from..].iter().for_each(|day| week.add(day));
        Some(week)
    }

    /// Returns the last day on which a call names a customer who came after the start of the branches. Such customers have other
    /// numbers in a branch with more or fewer customers.
    fn last_meeting(&self, edits: &[Edits]) -> Option<u32> {
        let first_new = self.start.world.customers.next_customer;
        let is_met = |tool, args| highest_named(tool, args) >= Some(first_new);
        let made = self.moves.iter().filter_map(|step| match step {
            Move::Call(call) => Some(call),
            Move::Parameter(_) | Move::Days(_) => None,
        });
        let kept = made.clone().filter(|call| is_met(call.tool, &call.args)).map(|call| call.day);
        let changed = made.filter(|call| {
            let mut other = edits.iter().filter_map(|own| own.changed.get(&call.seq));
            other.any(|args| is_met(call.tool, args))
        });
        let added = edits.iter().flat_map(|own| &own.added).filter(|call| is_met(call.tool, &call.args));
        kept.chain(changed.map(|call| call.day)).chain(added.map(|call| call.day)).max()
    }

    /// Simulates the days with each of several edits. Returns `None` if stopped.
    ///
    /// # Errors
    /// `too_many_leads` if a day of a branch exceeds the limits of memory.
    fn simulate(
        &self,
        edits: &[Edits],
        progress: OnWhatIfProgress<'_>,
    ) -> Result<Option<Vec<BranchOutcome>>, Refusal> {
        let days = (self.until - self.start.world.day) as usize * edits.len();
        let done = AtomicUsize::new(0);
        let outcomes = one_each(edits, |own, stopped| {
            let mut go_on = |_| {
                let day = done.fetch_add(1, Ordering::Relaxed) + 1;
                match progress(day, days).is_break() || stopped.is_set() {
                    true => ControlFlow::Break(()),
                    false => ControlFlow::Continue(()),
                }
            };
            counterfactual(&self.start, &self.moves, own, self.until, &mut go_on)
        });
        match outcomes.iter().flatten().find_map(|outcome| outcome.crowded.clone()) {
            Some(Refusal { code, message, .. }) => {
                Err(Refusal::new(code, format!("in one of the branches {message}")))
            }
            None => Ok(outcomes),
        }
    }
}

/// Returns the latest possible first day on which two branches differ: the end of the first week with different figures, or
/// `None` if all figures are equal.
fn differs_by(one: &BranchOutcome, other: &BranchOutcome) -> Option<u32> {
    let other_figures = one.days.iter().zip(&other.days).find(|(own, their)| own != their);
    if let Some((day, _)) = other_figures {
        return Some(day.day);
    }
    let (one, other) = (&one.end.world, &other.end.world);
    (one.day != other.day || one.part_hashes() != other.part_hashes()).then_some(one.day.max(other.day))
}

/// The decision edits of each branch, the unchanged run first, and the resulting edits of recorded steps.
type AllEdits = (Vec<Vec<DecisionEdit>>, Vec<Edits>);

fn all_edits(alternatives: &[Vec<DecisionEdit>], parting: &Parting, mode: Mode) -> Result<AllEdits, Refusal> {
    if alternatives.len() > MOST_ALTERNATIVES {
        let message = format!("a what-if compares at most {MOST_ALTERNATIVES} alternatives");
        return Err(Refusal::new("too_many_alternatives", message));
    }
    let Parting { start, moves, until, .. } = parting;
    let all: Vec<Vec<DecisionEdit>> =
        std::iter::once(Vec::new()).chain(alternatives.iter().cloned()).collect();
    let opening = decision_edit::Opening::of(start, mode);
    let edits = all.iter().map(|decided| decision_edit::edits(decided, &opening, moves, *until));
    let edits = edits.collect::<Result<_, _>>()?;
    Ok((all, edits))
}
