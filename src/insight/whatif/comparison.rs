//! Branches of a run side by side.

use serde_json::Value;

use super::decision_edit::DecisionEdit;
use super::figure::{BranchFigure, Values, values};
use crate::counterfactual::branch::BranchOutcome;
use crate::counterfactual::edits::{AddedCall, Edits};
use crate::counterfactual::script::{Move, PastCall, PastSetting};
use novamind_session::engine::json_of_value;
use novamind_tools::{Kind, Refusal, ToolId};
use novamind_world::events::DayFigures;

/// Branches of a run, under the same luck.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchComparison {
    /// Day on which they part: the start of the week that was named.
    pub from: u32,
    /// Last day that was simulated.
    pub until: u32,
    /// Last day of the record: after it nobody has decided anything, and the settings stay.
    pub recorded_until: u32,
    /// The run as it was, then each alternative.
    pub branches: Vec<BranchFigures>,
    /// Figures that may be shown.
    pub figures: Vec<BranchFigure>,
}

/// What came of a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchFigures {
    /// What was decided otherwise; nothing in the run as it was.
    pub edits: Vec<DecisionEdit>,
    /// Its last days of weeks, the first of the what-if first.
    days: Vec<u32>,
    /// Figures on those days.
    weeks: Vec<Values>,
    /// Calls that differ from those of the run, by day.
    pub differences: Vec<DecisionDifference>,
    /// Parameters that are set otherwise, by day.
    pub parameters: Vec<ParameterDifference>,
    /// Calls that are refused here, and parameters that do not fit: day, tool or key, why.
    pub refused: Vec<(u32, String, Refusal)>,
    /// Calls that were refused in the run and would be accepted here: line, day, tool. They are not made.
    pub possible: Vec<(u64, u32, ToolId)>,
    /// First day at whose end the company is another than in the run as it was; none if there is none.
    pub differs_on: Option<u32>,
}

/// A call that differs.
#[derive(Debug, Clone, PartialEq)]
pub struct DecisionDifference {
    /// Decision day.
    pub day: u32,
    /// Tool.
    pub tool: ToolId,
    /// Its line in the run; none for a call that is new.
    pub seq: Option<u64>,
    /// Its arguments in the run.
    pub was: Option<Value>,
    /// Its arguments here; none where it is not made.
    pub is: Option<Value>,
    /// Of a call that is new: day and line of the next call of its tool, which the run makes later.
    pub again: Option<(u32, u64)>,
}

/// A parameter that is set otherwise.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterDifference {
    /// Day from which on it acts.
    pub day: u32,
    /// Full key.
    pub key: String,
    /// What the run sets there; none where it does not.
    pub was: Option<Value>,
    /// What is set here; none where it is not.
    pub is: Option<Value>,
}

impl BranchFigures {
    pub(super) fn of(
        edits: &[DecisionEdit],
        (made, moves, from): (&Edits, &[Move], u32),
        earlier: &[DayFigures],
        outcome: &BranchOutcome,
        differs_on: Option<u32>,
    ) -> BranchFigures {
        let calls =
            outcome.refused.iter().map(|call| (call.day, call.tool.name().to_owned(), call.refusal.clone()));
        let mut refused: Vec<_> = calls.chain(outcome.unfit.iter().cloned()).collect();
        refused.sort_by_key(|(day, ..)| *day);
        let possible = outcome.possible.iter().map(|call| (call.seq, call.day, call.tool));
        let followed = outcome.followed.iter().map(|call| new_call(call.day, call.tool, &call.args));
        let mut differences: Vec<_> = differences(made, moves, from).into_iter().chain(followed).collect();
        differences.sort_by_key(|call| call.day);
        BranchFigures {
            edits: edits.to_vec(),
            days: outcome.weeks.iter().map(|week| week.day).collect(),
            weeks: values(earlier, outcome),
            differences,
            parameters: parameters(made, moves),
            refused,
            possible: possible.collect(),
            differs_on,
        }
    }

    /// A figure at the end of each week: its last day and the value.
    pub fn curve(&self, figure: BranchFigure) -> impl Iterator<Item = (u32, f64)> {
        self.days.iter().zip(&self.weeks).map(move |(day, values)| (*day, values[figure as usize]))
    }

    /// A figure at the end of the week that a day closes; none where the branch did not come so far.
    pub fn value(&self, figure: BranchFigure, day: u32) -> Option<f64> {
        self.curve(figure).find(|(own, _)| *own == day).map(|(_, value)| value)
    }

    /// The last day it came to.
    pub fn last_day(&self) -> Option<u32> {
        self.days.last().copied()
    }
}

impl BranchComparison {
    /// Days on which figures are read: 4, 12 and 26 weeks after the branches part, and the last.
    pub fn milestones(&self, days_per_week: u32) -> Vec<u32> {
        let weeks = [4, 12, 26].map(|weeks| self.from + weeks * days_per_week);
        let mut days: Vec<u32> = weeks.into_iter().filter(|day| *day < self.until).collect();
        days.push(self.until);
        days
    }
}

/// A call that the run did not make.
fn new_call(day: u32, tool: ToolId, args: &Value) -> DecisionDifference {
    DecisionDifference { day, tool, seq: None, was: None, is: Some(args.clone()), again: None }
}

/// The calls that edits change.
fn differences(edits: &Edits, moves: &[Move], from: u32) -> Vec<DecisionDifference> {
    let opening = edits.opening.iter().map(|(tool, args)| new_call(from, *tool, args));
    let next = |added: &AddedCall| {
        moves.iter().find_map(|step| match step {
            Move::Call(call)
                if call.tool == added.tool
                    && call.day > added.day
                    && call.accepted
                    && !edits.dropped.contains(&call.seq) =>
            {
                Some((call.day, call.seq))
            }
            _ => None,
        })
    };
    let added = edits.added.iter().map(|call| {
        let is_set = call.tool.spec().kind == Kind::Setting;
        let again = if is_set { next(call) } else { None };
        DecisionDifference { again, ..new_call(call.day, call.tool, &call.args) }
    });
    let of_run = moves.iter().filter_map(|step| match step {
        Move::Call(call) => of_call(edits, call),
        Move::Parameter(_) | Move::Days(_) => None,
    });
    opening.chain(of_run).chain(added).collect()
}

/// The parameters that are set otherwise, by day.
fn parameters(edits: &Edits, moves: &[Move]) -> Vec<ParameterDifference> {
    let dropped = moves.iter().filter_map(|step| match step {
        Move::Parameter(PastSetting { day, change }) if edits.dropped.contains(&change.seq) => {
            Some(ParameterDifference {
                day: change.from_day.map_or(*day, |from| from - 1),
                key: change.key.clone(),
                was: Some(json_of_value(&change.value)),
                is: None,
            })
        }
        _ => None,
    });
    let added = edits.set.iter().map(|setting| ParameterDifference {
        day: setting.day,
        key: setting.key.clone(),
        was: None,
        is: Some(setting.value.clone()),
    });
    let mut all: Vec<ParameterDifference> = dropped.chain(added).collect();
    all.sort_by_key(|own| own.day);
    all
}

fn of_call(edits: &Edits, call: &PastCall) -> Option<DecisionDifference> {
    let is = match edits.changed.get(&call.seq) {
        _ if edits.dropped.contains(&call.seq) => None,
        Some(args) => Some(args.clone()),
        None => return None,
    };
    if !call.accepted && is.is_none() || is.as_ref() == Some(&call.args) {
        return None;
    }
    Some(DecisionDifference {
        day: call.day,
        tool: call.tool,
        seq: Some(call.seq),
        was: Some(call.args.clone()),
        is,
        again: None,
    })
}
