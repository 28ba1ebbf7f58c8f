//! Re-simulates a week repeatedly, each time without other causes.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::access::Sight;
use super::cause::{Cause, Detail};
use super::inputs::TwoWeeks;
use super::{OnProgress, WhyProgress};
use crate::counterfactual::branch::{BranchOutcome, counterfactual};
use crate::counterfactual::edits::Edits;
use crate::counterfactual::kept_state::KeptState;
use crate::counterfactual::one_each::one_each;
use crate::counterfactual::past::Past;
use crate::counterfactual::script::{Move, PastCall};
use novamind_record::error::RunError;
use novamind_record::figures::{GroupOfWeek, SimulatedWeek};
use novamind_session::engine::changes;
use novamind_tools::Kind;
use novamind_world::events::DayFigures;
use novamind_world::held::Held;
use novamind_world::identifiers::{ByGroup, Group};

/// A set of removed causes: one bit for each tool and each input, by index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Without {
    pub calls: u32,
    pub inputs: u32,
}

/// A cause that can be removed.
pub(super) struct Candidate {
    pub cause: Cause,
    pub details: Vec<Detail>,
    /// Lines of its calls; empty for an input.
    lines: BTreeSet<u64>,
}

/// A week, the week before, and the results of simulations.
pub(super) struct Laboratory {
    week: u32,
    between: Arc<KeptState>,
    moves: Vec<Move>,
    before: BranchOutcome,
    after: BranchOutcome,
    week_before: SimulatedWeek,
    pub(super) sight: Sight,
    /// Tools that the player called.
    pub(super) calls: Vec<Candidate>,
    pub(super) inputs: Vec<Candidate>,
    /// Days without any call; `None` until simulated.
    undone: Vec<DayFigures>,
    known: BTreeMap<Without, SimulatedWeek>,
}

impl Laboratory {
    /// Prepares a week of a run. Returns `None` if stopped.
    ///
    /// # Errors
    /// Returns an error if the simulation does not reproduce the recorded states.
    pub(super) fn of(
        past: &mut Past,
        sight: Sight,
        week: u32,
        progress: OnProgress<'_>,
    ) -> Result<Option<Laboratory>, RunError> {
        let days = past.days_per_week();
        let [from, eve, end] = [week - 2, week - 1, week].map(|week| (week * days).min(past.manifest.days));
        let mut reach = |day| progress(WhyProgress::Reaching(day, end));
        let Some(start) = past.moment(from, &mut reach)? else { return Ok(None) };
        let Some(between) = past.moment(eve, &mut reach)? else { return Ok(None) };
        let none = Edits::default();
        let Some(before) = counterfactual(&start, past.between(from, eve), &none, eve, &mut reach) else {
            return Ok(None);
        };
        let moves = past.between(eve, end).to_vec();
        let Some(after) = counterfactual(&between, &moves, &none, end, &mut reach) else { return Ok(None) };
        past.compare(end, &after.end)?;
        let two = TwoWeeks { between: &between, before: &before, after: &after };
        let input = |(cause, details)| Candidate { cause, details, lines: BTreeSet::new() };
        let inputs = two.differing().into_iter().map(input).collect();
        let mut calls = decided(&between, &moves, &after);
        calls.extend(set_parameters(&between, &moves, end));
        let actual = Without { calls: 0, inputs: 0 };
        let known = BTreeMap::from([(actual, simulated_week(&between, &after))]);
        let week_before = simulated_week(&start, &before);
        let undone = Vec::new();
        Ok(Some(Laboratory {
            week,
            between,
            moves,
            before,
            after,
            week_before,
            sight,
            calls,
            inputs,
            undone,
            known,
        }))
    }

    pub(super) fn week(&self) -> u32 {
        self.week
    }

    /// Returns the number of days of the week before and of the week.
    pub(super) fn days(&self) -> [u32; 2] {
        [&self.before, &self.after].map(|outcome| outcome.days.len() as u32)
    }

    pub(super) fn week_before(&self) -> &SimulatedWeek {
        &self.week_before
    }

    /// Whether a group was discovered at the end of the week.
    pub(super) fn knows(&self, group: Group) -> bool {
        self.after.end.world.market.is_known(group)
    }

    /// Returns the number of re-simulated weeks.
    pub(super) fn simulated(&self) -> usize {
        self.known.len() - 1
    }

    /// Returns the figures of the week without some causes, which must be simulated already.
    pub(super) fn without(&self, without: Without) -> &SimulatedWeek {
        &self.known[&without]
    }

    /// Simulates the sets that have no result yet. Returns `None` if stopped.
    pub(super) fn find_out(&mut self, wanted: &[Without], progress: OnProgress<'_>) -> Option<()> {
        // Utilization is relative to days without any call.
        let undone = Without { calls: (1 << self.calls.len()) - 1, inputs: 0 };
        if self.undone.is_empty() && wanted.iter().any(|without| without.inputs != 0) {
            let outcome = self.simulate(undone, &mut |_| ControlFlow::Continue(()))?;
            self.known.insert(undone, simulated_week(&self.between, &outcome));
            self.undone = outcome.days;
        }
        let unknown: BTreeSet<Without> =
            wanted.iter().copied().filter(|without| !self.known.contains_key(without)).collect();
        let found = self.simulate_all(&unknown.into_iter().collect::<Vec<_>>(), progress)?;
        self.known.extend(found);
        Some(())
    }

    fn simulate_all(
        &self,
        wanted: &[Without],
        progress: OnProgress<'_>,
    ) -> Option<Vec<(Without, SimulatedWeek)>> {
        let done = AtomicUsize::new(0);
        one_each(wanted, |without, stopped| {
            let mut go_on = |_| match stopped.is_set() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            let outcome = self.simulate(*without, &mut go_on)?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            match progress(WhyProgress::Simulated(done, wanted.len())) {
                ControlFlow::Break(()) => None,
                ControlFlow::Continue(()) => Some((*without, simulated_week(&self.between, &outcome))),
            }
        })
    }

    fn simulate(
        &self,
        without: Without,
        go_on: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Option<BranchOutcome> {
        let dropped = chosen(&self.calls, without.calls).flat_map(|own| own.lines.iter().copied()).collect();
        let held = match without.inputs {
            0 => Held::default(),
            inputs => {
                let two = TwoWeeks { between: &self.between, before: &self.before, after: &self.after };
                two.held(chosen(&self.inputs, inputs).map(|own| own.cause), &self.undone)
            }
        };
        let edits = Edits { dropped, held, ..Edits::default() };
        let outcome = counterfactual(&self.between, &self.moves, &edits, self.after.end.world.day, go_on)?;
        // The figures of a week that ends early cannot be compared with those of a complete week.
        outcome.crowded.is_none().then_some(outcome)
    }
}

fn chosen(candidates: &[Candidate], set: u32) -> impl Iterator<Item = &Candidate> {
    candidates.iter().enumerate().filter(move |(at, _)| set & (1 << at) != 0).map(|(_, own)| own)
}

/// Returns the player's calls in the week by tool. A setting that returned to its first value counts only if days passed in between.
fn decided(eve: &KeptState, moves: &[Move], after: &BranchOutcome) -> Vec<Candidate> {
    let set = changes(&eve.world.settings, &after.end.world.settings);
    let in_steps = moves.iter().filter(|step| matches!(step, Move::Days(_))).count() > 1;
    let mut by_tool: Vec<Candidate> = Vec::new();
    for call in moves.iter().filter_map(accepted) {
        let cause = Cause::Calls(call.tool);
        match by_tool.iter_mut().find(|own| own.cause == cause) {
            Some(own) => drop(own.lines.insert(call.seq)),
            None => {
                let lines = BTreeSet::from([call.seq]);
                by_tool.push(Candidate { cause, details: Vec::new(), lines });
            }
        }
    }
    by_tool.retain_mut(|own| {
        let Cause::Calls(tool) = own.cause else { return false };
        let changed = set.iter().filter(|change| change.setting.tool() == tool);
        own.details = changed.map(|change| Detail::Setting(*change)).collect();
        if tool.tool().spec().kind == Kind::Setting {
            return in_steps || !own.details.is_empty();
        }
        own.details = vec![Detail::Happened(own.lines.len(), "call")];
        true
    });
    by_tool
}

/// Returns the parameters that were set in the week or took effect in it.
fn set_parameters(eve: &KeptState, moves: &[Move], end: u32) -> Option<Candidate> {
    let set = moves.iter().filter_map(|step| match step {
        Move::Parameter(setting) => Some(&setting.change),
        Move::Call(_) | Move::Days(_) => None,
    });
    let acting = eve.overrides.waiting().chain(set).filter(|change| change.from_day <= Some(end));
    let lines: BTreeSet<u64> = acting.map(|change| change.seq).collect();
    let details = vec![Detail::Happened(lines.len(), "setting")];
    (!lines.is_empty()).then_some(Candidate { cause: Cause::Parameters, details, lines })
}

fn accepted(step: &Move) -> Option<&PastCall> {
    match step {
        Move::Call(call) if call.accepted => Some(call),
        _ => None,
    }
}

/// Returns the last week of the days after a state, which are at most one week.
fn simulated_week(before: &KeptState, outcome: &BranchOutcome) -> SimulatedWeek {
    let measured = outcome.groups.last().copied().unwrap_or_default();
    SimulatedWeek {
        figures: outcome.weeks.last().copied().unwrap_or_default(),
        satisfaction: outcome.satisfaction.last().copied().unwrap_or(f64::NAN),
        groups: ByGroup::from_fn(|group| GroupOfWeek {
            measured: measured[group],
            subscribers_before: before.world.customers.groups[group].active(),
        }),
    }
}
