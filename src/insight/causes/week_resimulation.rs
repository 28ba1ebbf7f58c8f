//! Re-simulations of a week, each of which removes a different set of causes.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::cause::{Cause, CauseDetail};
use super::continued::{TwoWeeks, continued_causes};
use super::inputs::WeekPair;
use super::visibility::InputVisibility;
use super::{CauseProgress, CauseProgressFn};
use crate::counterfactual::branch::{BranchOutcome, simulate_branch};
use crate::counterfactual::edits::Edits;
use crate::counterfactual::memory_snapshot::MemorySnapshot;
use crate::counterfactual::parallel_map::parallel_map;
use crate::counterfactual::recorded_run::RecordedRun;
use crate::counterfactual::recorded_steps::{RecordedCall, RecordedStep};
use novamind_record::error::RunError;
use novamind_record::figures::{SimulatedWeek, WeekGroupFigures};
use novamind_session::engine::setting_changes;
use novamind_tools::ToolKind;
use novamind_world::events::DayFigures;
use novamind_world::fixed_inputs::FixedInputs;
use novamind_world::identifiers::{ByGroup, Group};

/// Number of weeks that are simulated for each set of continuing causes.
const WEEKS_PER_CONTINUED_SET: usize = 3;

/// Bit masks of the removed causes. The position of a bit is the index of the tool or the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ExcludedCauses {
    pub calls: u32,
    pub inputs: u32,
}

/// A cause that can be removed from a week.
pub(super) struct RemovableCause {
    pub cause: Cause,
    pub details: Vec<CauseDetail>,
    /// Lines of the cause's calls in the trajectory; empty for a world input.
    pub lines: BTreeSet<u64>,
}

/// An explained week, the previous week, and the results of re-simulations.
pub(super) struct WeekResimulation {
    week: u32,
    /// State before the previous week.
    pub(super) start_before: Arc<MemorySnapshot>,
    pub(super) steps_before: Vec<RecordedStep>,
    /// State between the two weeks.
    pub(super) start: Arc<MemorySnapshot>,
    pub(super) steps: Vec<RecordedStep>,
    before: BranchOutcome,
    pub(super) after: BranchOutcome,
    week_before: SimulatedWeek,
    pub(super) visibility: InputVisibility,
    /// Tools that the player called in the week.
    pub(super) calls: Vec<RemovableCause>,
    pub(super) inputs: Vec<RemovableCause>,
    /// Figures of the week's days, simulated without the player's calls; empty before this simulation.
    days_without_calls: Vec<DayFigures>,
    simulated_weeks: BTreeMap<ExcludedCauses, SimulatedWeek>,
    /// Causes that continue from the previous week.
    pub(super) continued: Vec<Cause>,
    /// Simulations of both weeks, indexed by the bit mask of the continuing causes that act; empty until simulated.
    pub(super) continued_weeks: Vec<Option<TwoWeeks>>,
}

impl WeekResimulation {
    /// Prepares the re-simulation of a week. Returns `None` if `progress` stopped the simulation.
    ///
    /// # Errors
    /// Returns an error if the simulation does not reproduce the recorded states.
    pub(super) fn new(
        past: &mut RecordedRun,
        sight: InputVisibility,
        week: u32,
        progress: CauseProgressFn<'_>,
    ) -> Result<Option<WeekResimulation>, RunError> {
        let days = past.days_per_week();
        let [from, eve, end] = [week - 2, week - 1, week].map(|week| (week * days).min(past.manifest.days));
        let mut reach = |day| progress(CauseProgress::Replaying(day, end));
        let Some(start) = past.snapshot_at(from, &mut reach)? else { return Ok(None) };
        let Some(between) = past.snapshot_at(eve, &mut reach)? else { return Ok(None) };
        let none = Edits::default();
        let Some(before) = simulate_branch(&start, past.steps_between(from, eve), &none, eve, &mut reach)
        else {
            return Ok(None);
        };
        let moves = past.steps_between(eve, end).to_vec();
        let Some(after) = simulate_branch(&between, &moves, &none, end, &mut reach) else { return Ok(None) };
        past.verify_state(end, &after.final_state)?;
        let two = WeekPair { start: &between, before: &before, after: &after };
        let input = |(cause, details)| RemovableCause { cause, details, lines: BTreeSet::new() };
        let inputs = two.differing_inputs().into_iter().map(input).collect();
        let mut calls = removable_call_causes(&between, &moves, &after);
        calls.extend(removable_parameter_cause(&between, &moves, end));
        let actual = ExcludedCauses { calls: 0, inputs: 0 };
        let known = BTreeMap::from([(actual, last_simulated_week(&between, &after))]);
        let week_before = last_simulated_week(&start, &before);
        let undone = Vec::new();
        let continued = continued_causes(&start, &between);
        Ok(Some(WeekResimulation {
            week,
            steps_before: past.steps_between(from, eve).to_vec(),
            start_before: start,
            start: between,
            steps: moves,
            before,
            after,
            week_before,
            visibility: sight,
            calls,
            inputs,
            days_without_calls: undone,
            simulated_weeks: known,
            continued,
            continued_weeks: Vec::new(),
        }))
    }

    pub(super) fn week(&self) -> u32 {
        self.week
    }

    /// Returns the number of days in the previous week and in the explained week.
    pub(super) fn days(&self) -> [u32; 2] {
        [&self.before, &self.after].map(|outcome| outcome.days.len() as u32)
    }

    pub(super) fn week_before(&self) -> &SimulatedWeek {
        &self.week_before
    }

    /// Returns whether a group had been discovered by the end of the week.
    pub(super) fn is_group_known(&self, group: Group) -> bool {
        self.after.final_state.world.market.is_known(group)
    }

    /// Returns how many weeks have been re-simulated.
    pub(super) fn simulation_count(&self) -> usize {
        self.simulated_weeks.len() - 1 + WEEKS_PER_CONTINUED_SET * self.continued_weeks.len()
    }

    /// Returns the figures of the week without the excluded causes. This simulation must have been run already.
    pub(super) fn week_without(&self, without: ExcludedCauses) -> &SimulatedWeek {
        &self.simulated_weeks[&without]
    }

    /// Simulates the week for each set of causes that has no cached result. Returns `None` if `progress` stopped the
    /// simulation.
    pub(super) fn simulate_missing(
        &mut self,
        wanted: &[ExcludedCauses],
        progress: CauseProgressFn<'_>,
    ) -> Option<()> {
        // Fixed inputs include the utilization, which is computed from the usage in a simulation without the player's
        // calls.
        let undone = ExcludedCauses { calls: (1 << self.calls.len()) - 1, inputs: 0 };
        if self.days_without_calls.is_empty() && wanted.iter().any(|without| without.inputs != 0) {
            let outcome = self.simulate(undone, &mut |_| ControlFlow::Continue(()))?;
            self.simulated_weeks.insert(undone, last_simulated_week(&self.start, &outcome));
            self.days_without_calls = outcome.days;
        }
        let unknown: BTreeSet<ExcludedCauses> =
            wanted.iter().copied().filter(|without| !self.simulated_weeks.contains_key(without)).collect();
        let unknown: Vec<ExcludedCauses> = unknown.into_iter().collect();
        let found = self.simulate_in_parallel(&unknown, progress, |without, go_on| {
            let outcome = self.simulate(without, go_on)?;
            Some((without, last_simulated_week(&self.start, &outcome)))
        })?;
        self.simulated_weeks.extend(found);
        Some(())
    }

    /// Runs a simulation for every set of causes, in parallel. Returns `None` if `progress` stopped the simulations.
    pub(super) fn simulate_in_parallel<S: Copy + Sync, R: Send>(
        &self,
        wanted: &[S],
        progress: CauseProgressFn<'_>,
        simulate: impl Fn(S, &mut dyn FnMut(u32) -> ControlFlow<()>) -> Option<R> + Sync,
    ) -> Option<Vec<R>> {
        let done = AtomicUsize::new(0);
        parallel_map(wanted, |set, stopped| {
            let mut go_on = |_| match stopped.is_set() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            let result = simulate(*set, &mut go_on)?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            match progress(CauseProgress::Simulated(done, wanted.len())) {
                ControlFlow::Break(()) => None,
                ControlFlow::Continue(()) => Some(result),
            }
        })
    }

    fn simulate(
        &self,
        without: ExcludedCauses,
        go_on: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Option<BranchOutcome> {
        let dropped = selected_causes(&self.calls, without.calls)
            .flat_map(|candidate| candidate.lines.iter().copied())
            .collect();
        let fixed_inputs = match without.inputs {
            0 => FixedInputs::default(),
            inputs => {
                let two = WeekPair { start: &self.start, before: &self.before, after: &self.after };
                two.fix_inputs(
                    selected_causes(&self.inputs, inputs).map(|candidate| candidate.cause),
                    &self.days_without_calls,
                )
            }
        };
        let edits = Edits { dropped_lines: dropped, fixed_inputs, ..Edits::default() };
        let outcome =
            simulate_branch(&self.start, &self.steps, &edits, self.after.final_state.world.day, go_on)?;
        // The figures of a week that ended early cannot be compared with the figures of a complete week.
        outcome.lead_overflow.is_none().then_some(outcome)
    }
}

fn selected_causes(candidates: &[RemovableCause], set: u32) -> impl Iterator<Item = &RemovableCause> {
    candidates.iter().enumerate().filter(move |(at, _)| set & (1 << at) != 0).map(|(_, candidate)| candidate)
}

/// Returns the player's calls in the week as removable causes, one per tool. A setting that returned to its initial
/// value is included only if the week was simulated in several steps.
fn removable_call_causes(
    eve: &MemorySnapshot,
    moves: &[RecordedStep],
    after: &BranchOutcome,
) -> Vec<RemovableCause> {
    let set = setting_changes(&eve.world.settings, &after.final_state.world.settings);
    let in_steps = moves.iter().filter(|step| matches!(step, RecordedStep::Days(_))).count() > 1;
    let mut by_tool: Vec<RemovableCause> = Vec::new();
    for call in moves.iter().filter_map(accepted_call) {
        let cause = Cause::Calls(call.tool);
        match by_tool.iter_mut().find(|candidate| candidate.cause == cause) {
            Some(candidate) => drop(candidate.lines.insert(call.seq)),
            None => {
                let lines = BTreeSet::from([call.seq]);
                by_tool.push(RemovableCause { cause, details: Vec::new(), lines });
            }
        }
    }
    by_tool.retain_mut(|candidate| {
        let Cause::Calls(tool) = candidate.cause else { return false };
        let changed = set.iter().filter(|change| change.setting.tool() == tool);
        candidate.details = changed.map(|change| CauseDetail::Setting(*change)).collect();
        if tool.tool().spec().kind == ToolKind::Setting {
            return in_steps || !candidate.details.is_empty();
        }
        candidate.details = vec![CauseDetail::Occurrences(candidate.lines.len(), "call")];
        true
    });
    by_tool
}

/// Returns the parameter changes that were made or took effect in the week, as one removable cause.
fn removable_parameter_cause(
    eve: &MemorySnapshot,
    moves: &[RecordedStep],
    end: u32,
) -> Option<RemovableCause> {
    let set = moves.iter().filter_map(|step| match step {
        RecordedStep::Parameter(setting) => Some(&setting.change),
        RecordedStep::Call(_) | RecordedStep::Days(_) => None,
    });
    let acting = eve.overrides.scheduled_changes().chain(set).filter(|change| change.from_day <= Some(end));
    let lines: BTreeSet<u64> = acting.map(|change| change.seq).collect();
    let details = vec![CauseDetail::Occurrences(lines.len(), "setting")];
    (!lines.is_empty()).then_some(RemovableCause { cause: Cause::Parameters, details, lines })
}

fn accepted_call(step: &RecordedStep) -> Option<&RecordedCall> {
    match step {
        RecordedStep::Call(call) if call.accepted => Some(call),
        _ => None,
    }
}

/// Returns the figures of the last week in `outcome`, a simulation of at most one week after `before`.
pub(super) fn last_simulated_week(before: &MemorySnapshot, outcome: &BranchOutcome) -> SimulatedWeek {
    let measured = outcome.groups.last().copied().unwrap_or_default();
    SimulatedWeek {
        figures: outcome.weeks.last().copied().unwrap_or_default(),
        satisfaction: outcome.satisfaction.last().copied().unwrap_or(f64::NAN),
        groups: ByGroup::from_fn(|group| WeekGroupFigures {
            figures: measured[group],
            subscribers_before: before.world.customers.groups[group].active_count(),
        }),
    }
}
