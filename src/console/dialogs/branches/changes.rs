//! The changes of an alternative: decisions that are left out, scaled, replaced or added.

use serde_json::Value;

use novamind_insight::{
    DecisionEdit, DecisionHistory, RecordedCall, RecordedDecision, is_scalable, scale_numbers,
};
use novamind_report::decision_words::{decision_name, describe_value_changes};
use novamind_report::pluralize;
use novamind_session::EnterpriseNames;
use novamind_tools::ToolId;
use novamind_tui::text::format_number;

/// The treatment of a recorded decision in an alternative.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Treatment {
    Keep,
    LeaveOut,
    /// Multiplies the amounts of the decision by a factor.
    Scale(f64),
    /// Replaces the arguments of the call.
    Replace(Value),
}

/// A change that an alternative makes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Change {
    /// A change of the recorded decision in a line of the trajectory.
    Recorded { line: u64, treatment: Treatment },
    /// A call that is added at the start of a week.
    Added { week: u32, tool: ToolId, args: Value },
    /// A parameter that is set at the start of a week, in a debug run.
    Parameter { week: u32, key: String, value: Value },
    /// An edit that concerns all weeks from the first changed week on.
    AllWeeks { week: u32, edit: DecisionEdit },
}

/// A change, with the reason if the change was refused.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ListedChange {
    pub change: Change,
    pub problem: Option<Problem>,
}

/// The reason why a change was refused.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Problem {
    /// The change cannot be simulated.
    Invalid(String),
    /// The simulated company rejected the decision.
    Rejected(String),
}

impl From<Change> for ListedChange {
    fn from(change: Change) -> ListedChange {
        ListedChange { change, problem: None }
    }
}

impl Problem {
    pub(super) fn text(&self) -> String {
        match self {
            Problem::Invalid(reason) => reason.clone(),
            Problem::Rejected(reason) => format!("rejected in the simulation: {reason}"),
        }
    }
}

impl Change {
    /// Returns the week in which the change takes effect.
    pub(super) fn week(&self, history: &DecisionHistory) -> u32 {
        match self {
            Change::Recorded { line, .. } => {
                history.decision(*line).map_or(1, |decision| history.decision_week(decision))
            }
            Change::Added { week, .. } | Change::Parameter { week, .. } | Change::AllWeeks { week, .. } => {
                *week
            }
        }
    }

    /// Returns the edit that makes the change, or `None` for a decision that is kept.
    pub(super) fn edit(&self, history: &DecisionHistory) -> Option<DecisionEdit> {
        Some(match self {
            Change::Recorded { line, treatment } => match treatment {
                Treatment::Keep => return None,
                Treatment::LeaveOut => DecisionEdit::Drop(*line),
                treatment => {
                    let call = history.decision(*line)?.call()?;
                    DecisionEdit::Change { seq: *line, args: treatment.arguments(call) }
                }
            },
            Change::Added { week, tool, args } => {
                DecisionEdit::Add { week: Some(*week), tool: *tool, args: args.clone() }
            }
            Change::Parameter { week, key, value } => {
                DecisionEdit::Set { week: Some(*week), key: key.clone(), value: value.clone() }
            }
            Change::AllWeeks { edit, .. } => edit.clone(),
        })
    }

    /// Describes the change in words. `start` is the first changed week of the what-if.
    pub(super) fn describe(&self, history: &DecisionHistory, names: &EnterpriseNames, start: u32) -> String {
        match self {
            Change::Recorded { line, treatment } => match history.decision(*line) {
                Some(decision) => describe_treatment(decision, treatment, history, names),
                None => String::new(),
            },
            Change::Added { week, tool, args } => {
                let before = history.values_in_week(*tool, *week);
                let values = describe_value_changes(*tool, &before, args, names);
                format!("add {} {values}", decision_name(*tool)).trim_end().to_owned()
            }
            Change::Parameter { key, value, .. } => format!("set {key} to {value}"),
            Change::AllWeeks { edit, .. } => match edit {
                DecisionEdit::Scale { tool, factor } => {
                    format!("{} × {} from week {start} on", decision_name(*tool), format_factor(*factor))
                }
                DecisionEdit::Keep(tool) => {
                    format!("leave out all {} decisions from week {start} on", decision_name(*tool))
                }
                _ => format!("capacity follows usage from week {start} on"),
            },
        }
    }
}

impl Treatment {
    /// Returns the arguments of a call after this treatment.
    pub(super) fn arguments(&self, call: &RecordedCall) -> Value {
        match self {
            Treatment::Scale(factor) => scale_numbers(&call.args, *factor),
            Treatment::Replace(args) => args.clone(),
            Treatment::Keep | Treatment::LeaveOut => call.args.clone(),
        }
    }

    /// Returns the label of the treatment in the list.
    pub(super) fn label(&self) -> String {
        match self {
            Treatment::Keep => "keep".to_owned(),
            Treatment::LeaveOut => "leave out".to_owned(),
            Treatment::Scale(factor) => format!("× {}", format_factor(*factor)),
            Treatment::Replace(_) => "replace".to_owned(),
        }
    }

    /// Returns the treatment that follows in the cycle keep, leave out, scale, replace. Skips treatments that are not
    /// possible for the decision.
    pub(super) fn next(&self, decision: &RecordedDecision) -> NextTreatment {
        let cycle =
            [NextTreatment::Keep, NextTreatment::LeaveOut, NextTreatment::Scale, NextTreatment::Replace];
        let here = match self {
            Treatment::Keep => 0,
            Treatment::LeaveOut => 1,
            Treatment::Scale(_) => 2,
            Treatment::Replace(_) => 3,
        };
        let mut following = cycle.into_iter().cycle().skip(here + 1).take(cycle.len());
        following.find(|next| next.refusal(decision).is_none()).unwrap_or(NextTreatment::Keep)
    }
}

/// A kind of treatment that the user can choose. Scaling needs a factor, and replacing needs values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum NextTreatment {
    Keep,
    LeaveOut,
    Scale,
    Replace,
}

impl NextTreatment {
    /// Returns the reason why the treatment is not possible for a decision.
    pub(super) fn refusal(self, decision: &RecordedDecision) -> Option<String> {
        let Some(call) = decision.call() else {
            let is_refused = matches!(self, NextTreatment::Scale | NextTreatment::Replace);
            return is_refused.then(|| {
                "A parameter change can be kept or left out. To set another value, leave it out and add a parameter."
                    .to_owned()
            });
        };
        match self {
            NextTreatment::LeaveOut if !call.accepted => Some(
                "This decision was rejected in your run and had no effect. Replace it instead.".to_owned(),
            ),
            NextTreatment::Scale if !call.accepted => {
                Some("This decision was rejected in your run. It can only be replaced.".to_owned())
            }
            NextTreatment::Scale => unscalable_reason(call.tool),
            NextTreatment::Replace => irreplaceable_reason(call.tool),
            NextTreatment::Keep | NextTreatment::LeaveOut => None,
        }
    }
}

/// Returns the reason why the values of a tool cannot be multiplied by a factor.
pub(super) fn unscalable_reason(tool: ToolId) -> Option<String> {
    let names: Vec<&str> = ToolId::all().filter(|tool| is_scalable(*tool)).map(decision_name).collect();
    (!is_scalable(tool)).then(|| {
        format!("{} is not an amount. Only amounts can be scaled: {}.", decision_name(tool), names.join(", "))
    })
}

fn irreplaceable_reason(tool: ToolId) -> Option<String> {
    let is_fixed = tool == ToolId::RejectEnterpriseDeal || tool.spec().arguments.is_empty();
    is_fixed.then(|| format!("{} has no values to replace. It can be kept or left out.", decision_name(tool)))
}

/// Describes a recorded decision with the values before and after: `price B 25 → 30`.
pub(super) fn describe_decision(
    decision: &RecordedDecision,
    history: &DecisionHistory,
    names: &EnterpriseNames,
) -> String {
    match decision {
        RecordedDecision::Call(call) => describe_arguments(call, &call.args, history, names),
        RecordedDecision::Parameter { key, value, .. } => format!("set {key} to {value}"),
    }
}

fn describe_arguments(
    call: &RecordedCall,
    args: &Value,
    history: &DecisionHistory,
    names: &EnterpriseNames,
) -> String {
    let values = describe_value_changes(call.tool, &history.values_before(call), args, names);
    format!("{} {values}", decision_name(call.tool)).trim_end().to_owned()
}

/// Describes a changed decision: `leave out price B 25 → 30`, or `price B 25 → 27 instead of B 25 → 30`.
pub(super) fn describe_treatment(
    decision: &RecordedDecision,
    treatment: &Treatment,
    history: &DecisionHistory,
    names: &EnterpriseNames,
) -> String {
    let recorded = describe_decision(decision, history, names);
    match (treatment, decision.call()) {
        (Treatment::Scale(_) | Treatment::Replace(_), Some(call)) => {
            let edited = describe_arguments(call, &treatment.arguments(call), history, names);
            let name = decision_name(call.tool);
            let before = recorded.strip_prefix(name).unwrap_or(&recorded).trim();
            format!("{edited} instead of {before}")
        }
        (Treatment::LeaveOut, _) => format!("leave out {recorded}"),
        _ => recorded,
    }
}

/// Describes the decisions of a week by their names: `3 decisions: price, daily spend`.
pub(super) fn describe_week(week: u32, history: &DecisionHistory) -> String {
    let mut names: Vec<&str> = Vec::new();
    let mut count = 0;
    for decision in history.decisions_of_week(week) {
        count += 1;
        let name = decision.call().map_or("parameters", |call| decision_name(call.tool));
        if !names.contains(&name) {
            names.push(name);
        }
    }
    format!("{}: {}", pluralize(count, "decision"), names.join(", "))
}

pub(super) fn format_factor(factor: f64) -> String {
    if factor.fract() == 0.0 { format_number(factor) } else { factor.to_string() }
}
