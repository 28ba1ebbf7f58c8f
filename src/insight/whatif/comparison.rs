//! Comparison of a run with its alternatives.

use serde_json::Value;

use super::decision_edit::DecisionEdit;
use super::figure::{BranchFigure, FigureValues, weekly_values};
use crate::counterfactual::branch::BranchOutcome;
use crate::counterfactual::edits::{AddedCall, Edits};
use crate::counterfactual::recorded_steps::{RecordedCall, RecordedSetting, RecordedStep};
use novamind_session::engine::value_to_json;
use novamind_tools::{Rejection, ToolId, ToolKind};
use novamind_world::events::DayFigures;

/// Figures of the unchanged run and of alternatives with the same random draws.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchComparison {
    /// Day on which the branches start: the start of the requested week.
    pub from: u32,
    /// Last simulated day of the branches.
    pub until: u32,
    /// Last recorded day. Later days have no decisions, so their settings do not change.
    pub recorded_until: u32,
    /// The unchanged run, followed by each alternative.
    pub branches: Vec<BranchFigures>,
    /// Figures that the player may see in the comparison.
    pub figures: Vec<BranchFigure>,
}

/// The results of one branch.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchFigures {
    /// Edits of the branch; empty for the unchanged run.
    pub edits: Vec<DecisionEdit>,
    /// Last day of each simulated week, in ascending order.
    days: Vec<u32>,
    /// Values of the figures at the end of each week.
    weeks: Vec<FigureValues>,
    /// Calls that differ from the calls of the run, sorted by day.
    pub call_differences: Vec<CallDifference>,
    /// Parameter changes that differ from the changes of the run, sorted by day.
    pub parameter_differences: Vec<ParameterDifference>,
    /// Calls and parameter changes that the branch rejects, sorted by day.
    pub rejected: Vec<RejectedDecision>,
    /// Calls that were rejected in the run and would be accepted in the branch: line, day, tool. The branch does not
    /// execute these calls.
    pub newly_accepted: Vec<(u64, u32, ToolId)>,
    /// First day at the end of which the branch differs from the unchanged run; `None` if the branch never differs.
    pub first_different_day: Option<u32>,
}

/// A call or parameter change that a branch rejects.
#[derive(Debug, Clone, PartialEq)]
pub struct RejectedDecision {
    /// Line of the decision in the record of the run; `None` for an added decision.
    pub seq: Option<u64>,
    /// Decision day on which the branch rejects the decision.
    pub day: u32,
    /// Name of the called tool, or full key of the parameter.
    pub name: String,
    /// Reason for the rejection.
    pub rejection: Rejection,
}

/// A call that differs between the run and the branch.
#[derive(Debug, Clone, PartialEq)]
pub struct CallDifference {
    /// Decision day of the call.
    pub day: u32,
    /// Tool of the call that differs.
    pub tool: ToolId,
    /// Line of the call in the record of the run; `None` for an added call.
    pub seq: Option<u64>,
    /// Arguments in the run; `None` for an added call.
    pub recorded: Option<Value>,
    /// Arguments in the branch; `None` if the branch omits the call.
    pub edited: Option<Value>,
    /// For an added call: day and line of the next call to the same tool in the run.
    pub next_recorded: Option<(u32, u64)>,
}

/// A parameter change that differs between the run and the branch.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterDifference {
    /// Day from which the change applies.
    pub day: u32,
    /// Full key of the parameter, for example `demand_surge.probability`.
    pub key: String,
    /// Value that the run sets; `None` if only the branch sets the parameter.
    pub recorded: Option<Value>,
    /// Value that the branch sets; `None` if only the run sets the parameter.
    pub edited: Option<Value>,
}

impl BranchFigures {
    pub(super) fn new(
        edits: &[DecisionEdit],
        (made, moves, from): (&Edits, &[RecordedStep], u32),
        earlier: &[DayFigures],
        outcome: &BranchOutcome,
        differs_on: Option<u32>,
    ) -> BranchFigures {
        let calls = outcome.rejected.iter().map(|call| RejectedDecision {
            seq: call.seq,
            day: call.day,
            name: call.tool.name().to_owned(),
            rejection: call.rejection.clone(),
        });
        let parameters = outcome.rejected_parameters.iter().cloned();
        let parameters =
            parameters.map(|(day, name, rejection)| RejectedDecision { seq: None, day, name, rejection });
        let mut refused: Vec<_> = calls.chain(parameters).collect();
        refused.sort_by_key(|decision| decision.day);
        let possible = outcome.newly_accepted.iter().map(|call| (call.seq, call.day, call.tool));
        let followed =
            outcome.capacity_calls.iter().map(|call| added_call_difference(call.day, call.tool, &call.args));
        let mut differences: Vec<_> =
            call_differences(made, moves, from).into_iter().chain(followed).collect();
        differences.sort_by_key(|call| call.day);
        BranchFigures {
            edits: edits.to_vec(),
            days: outcome.weeks.iter().map(|week| week.day).collect(),
            weeks: weekly_values(earlier, outcome),
            call_differences: differences,
            parameter_differences: parameter_differences(made, moves),
            rejected: refused,
            newly_accepted: possible.collect(),
            first_different_day: differs_on,
        }
    }

    /// Returns the values of a figure at the end of each week, as pairs of day and value.
    pub fn values_by_week(&self, figure: BranchFigure) -> impl Iterator<Item = (u32, f64)> {
        self.days.iter().zip(&self.weeks).map(move |(day, values)| (*day, values[figure as usize]))
    }

    /// Returns the value of a figure at the end of the week that ends on `day`, or `None` if the branch ended earlier.
    pub fn value(&self, figure: BranchFigure, day: u32) -> Option<f64> {
        self.values_by_week(figure).find(|(number, _)| *number == day).map(|(_, value)| value)
    }

    /// Returns the last simulated day of the branch.
    pub fn last_day(&self) -> Option<u32> {
        self.days.last().copied()
    }
}

impl BranchComparison {
    /// Returns the days for which figures are shown: the end of the first week in which a branch differs, 4, 12 and 26
    /// weeks after the start of the branches, and the last day.
    pub fn milestone_days(&self, days_per_week: u32) -> Vec<u32> {
        let differs_on = self.branches.iter().filter_map(|branch| branch.first_different_day).min();
        let weeks = differs_on.map(|day| day.saturating_sub(self.from).div_ceil(days_per_week));
        let weeks = weeks.into_iter().chain([4, 12, 26]).map(|weeks| self.from + weeks * days_per_week);
        let mut days: Vec<u32> = weeks.filter(|day| *day < self.until).chain([self.until]).collect();
        days.sort_unstable();
        days.dedup();
        days
    }
}

/// Returns the difference for a call that the run does not contain.
fn added_call_difference(day: u32, tool: ToolId, args: &Value) -> CallDifference {
    CallDifference { day, tool, seq: None, recorded: None, edited: Some(args.clone()), next_recorded: None }
}

fn call_differences(edits: &Edits, moves: &[RecordedStep], from: u32) -> Vec<CallDifference> {
    let opening = edits.initial_calls.iter().map(|(tool, args)| added_call_difference(from, *tool, args));
    let next = |added: &AddedCall| {
        moves.iter().find_map(|step| match step {
            RecordedStep::Call(call)
                if call.tool == added.tool
                    && call.day > added.day
                    && call.accepted
                    && !edits.dropped_lines.contains(&call.seq) =>
            {
                Some((call.day, call.seq))
            }
            _ => None,
        })
    };
    let added = edits.added_calls.iter().map(|call| {
        let is_set = call.tool.spec().kind == ToolKind::Setting;
        let again = if is_set { next(call) } else { None };
        CallDifference { next_recorded: again, ..added_call_difference(call.day, call.tool, &call.args) }
    });
    let of_run = moves.iter().filter_map(|step| match step {
        RecordedStep::Call(call) => edited_call_difference(edits, call),
        RecordedStep::Parameter(_) | RecordedStep::Days(_) => None,
    });
    opening.chain(of_run).chain(added).collect()
}

/// Returns the parameter changes that the edits add or omit, sorted by day.
fn parameter_differences(edits: &Edits, moves: &[RecordedStep]) -> Vec<ParameterDifference> {
    let dropped = moves.iter().filter_map(|step| match step {
        RecordedStep::Parameter(RecordedSetting { day, change })
            if edits.dropped_lines.contains(&change.seq) =>
        {
            Some(ParameterDifference {
                day: change.from_day.map_or(*day, |from| from - 1),
                key: change.key.clone(),
                recorded: Some(value_to_json(&change.value)),
                edited: None,
            })
        }
        _ => None,
    });
    let added = edits.added_settings.iter().map(|setting| ParameterDifference {
        day: setting.day,
        key: setting.key.clone(),
        recorded: None,
        edited: Some(setting.value.clone()),
    });
    let mut all: Vec<ParameterDifference> = dropped.chain(added).collect();
    all.sort_by_key(|parameter_difference| parameter_difference.day);
    all
}

fn edited_call_difference(edits: &Edits, call: &RecordedCall) -> Option<CallDifference> {
    let is = match edits.changed_arguments.get(&call.seq) {
        _ if edits.dropped_lines.contains(&call.seq) => None,
        Some(args) => Some(args.clone()),
        None => return None,
    };
    if !call.accepted && is.is_none() || is.as_ref() == Some(&call.args) {
        return None;
    }
    Some(CallDifference {
        day: call.day,
        tool: call.tool,
        seq: Some(call.seq),
        recorded: Some(call.args.clone()),
        edited: is,
        next_recorded: None,
    })
}
