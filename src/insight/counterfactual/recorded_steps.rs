//! The recorded steps of a run: tool calls, parameter changes and simulated days.

use std::collections::BTreeMap;

use serde_json::Value;

use novamind_record::trajectory::record::{Call, JudgedPost, Outcome, Reversal, VoiceAnswer};
use novamind_record::trajectory::{Line, Record};
use novamind_session::engine::{ParameterChange, value_to_json};
use novamind_tools::{ToolId, ToolKind};

/// A recorded step that can change the company.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum RecordedStep {
    /// A tool call that can change the company.
    Call(RecordedCall),
    /// A parameter change.
    Parameter(RecordedSetting),
    /// Days that were simulated in one step.
    Days(RecordedDays),
}

/// A recorded tool call.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedCall {
    /// Line number of the call in the trajectory.
    pub seq: u64,
    /// Decision day of the call.
    pub day: u32,
    /// Tool of the recorded call.
    pub tool: ToolId,
    /// Arguments of the recorded call.
    pub args: Value,
    /// Whether the run accepted the call.
    pub accepted: bool,
    /// The call that this call undid or redid; `None` for other calls. An edit of that call does not change the
    /// settings that this call restored.
    pub reversal: Option<Reversal>,
}

/// A recorded decision of the player.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordedDecision {
    /// A tool call by the player.
    Call(RecordedCall),
    /// A parameter change in a debug run.
    Parameter {
        /// Line number of the change in the trajectory.
        seq: u64,
        /// Decision day of the change.
        day: u32,
        /// Full key of the parameter, for example `demand_surge.probability`.
        key: String,
        /// New value of the parameter.
        value: Value,
        /// First day with the new value; `None` if the value applied immediately.
        from_day: Option<u32>,
    },
}

impl RecordedDecision {
    /// Returns the line number of the decision in the trajectory.
    pub fn seq(&self) -> u64 {
        match self {
            RecordedDecision::Call(RecordedCall { seq, .. }) | RecordedDecision::Parameter { seq, .. } => {
                *seq
            }
        }
    }

    /// Returns the decision day of the call or parameter change.
    pub fn day(&self) -> u32 {
        match self {
            RecordedDecision::Call(RecordedCall { day, .. }) | RecordedDecision::Parameter { day, .. } => {
                *day
            }
        }
    }

    /// Returns the tool call, or `None` for a parameter change.
    pub fn call(&self) -> Option<&RecordedCall> {
        match self {
            RecordedDecision::Call(call) => Some(call),
            RecordedDecision::Parameter { .. } => None,
        }
    }

    /// Describes the status of the decision: rejected, undo, redo, or the first day on which a parameter change
    /// applies. Returns an empty string for other decisions.
    pub fn describe_status(&self) -> String {
        match self {
            RecordedDecision::Call(RecordedCall { accepted: false, .. }) => "rejected".to_owned(),
            RecordedDecision::Call(RecordedCall { reversal: Some(Reversal::Undoes(line)), .. }) => {
                format!("undoes line {line}")
            }
            RecordedDecision::Call(RecordedCall { reversal: Some(Reversal::Redoes(line)), .. }) => {
                format!("redoes line {line}")
            }
            RecordedDecision::Call(_) => String::new(),
            RecordedDecision::Parameter { from_day, .. } => {
                from_day.map_or(String::new(), |day| format!("from day {day}"))
            }
        }
    }

    /// Returns the decision of a step, or `None` for simulated days.
    pub(crate) fn from_step(step: &RecordedStep) -> Option<RecordedDecision> {
        match step {
            RecordedStep::Call(call) => Some(RecordedDecision::Call(call.clone())),
            RecordedStep::Parameter(RecordedSetting { day, change }) => Some(RecordedDecision::Parameter {
                seq: change.seq,
                day: *day,
                key: change.key.clone(),
                value: value_to_json(&change.value),
                from_day: change.from_day,
            }),
            RecordedStep::Days(_) => None,
        }
    }
}

/// A recorded parameter change.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RecordedSetting {
    /// Decision day of the change.
    pub day: u32,
    /// The changed parameter with its new value.
    pub change: ParameterChange,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RecordedDays {
    /// Last day of the step.
    pub until: u32,
    /// Hash of the state at the end of the last day.
    pub state_hash: String,
    /// Hash of each part of the state, by name.
    pub parts: BTreeMap<String, String>,
    /// Scores that the language model gave to the player's posts.
    pub scores: Vec<JudgedPost>,
}

/// Returns the recorded steps in trajectory lines, in order.
pub(crate) fn steps_from_lines(lines: &[Line]) -> Vec<RecordedStep> {
    let mut scores = Vec::new();
    lines.iter().filter_map(|line| step_from_line(line, &mut scores)).collect()
}

/// Returns the step that an event records, or `None` if the event records no step. Collects scores in `scores` until
/// the event that records the days to which the scores apply.
fn step_from_line(line: &Line, scores: &mut Vec<JudgedPost>) -> Option<RecordedStep> {
    if let Some(closing) = line.record.closed_days() {
        let (state_hash, parts) = (closing.state_hash.clone(), closing.parts.clone());
        return Some(RecordedStep::Days(RecordedDays {
            until: line.day,
            state_hash,
            parts,
            scores: std::mem::take(scores),
        }));
    }
    if let Record::Voice(VoiceAnswer::Scores(judged)) = &line.record {
        scores.push(judged.clone());
        return None;
    }
    if let Record::Override(setting) = &line.record {
        let change = ParameterChange::from_record(line.seq, setting)?;
        return Some(RecordedStep::Parameter(RecordedSetting { day: line.day, change }));
    }
    let Record::Call(Call { tool, args, outcome, reversal, .. }) = &line.record else { return None };
    let tool = tool.tool_id()?;
    let kind = tool.spec().kind;
    (kind.changes_company() && kind != ToolKind::Time).then(|| {
        let accepted = matches!(outcome, Outcome::Accepted(_));
        let (args, reversal) = (args.clone(), *reversal);
        RecordedStep::Call(RecordedCall { seq: line.seq, day: line.day, tool, args, accepted, reversal })
    })
}

/// Returns the steps after day `from` up to day `until`. Decisions on a day follow the simulation of that day.
pub(crate) fn steps_between(moves: &[RecordedStep], from: u32, until: u32) -> &[RecordedStep] {
    let after = |day: u32| {
        let before = |step: &RecordedStep| match step {
            RecordedStep::Call(call) => call.day < day,
            RecordedStep::Parameter(setting) => setting.day < day,
            RecordedStep::Days(days) => days.until <= day,
        };
        moves.partition_point(before)
    };
    let (first, last) = (after(from), after(until));
    &moves[first..last.max(first)]
}

/// Returns whether an accepted call replies to another author's post, in which case the simulation needs the texts of
/// posts.
pub(crate) fn contains_post_replies(moves: &[RecordedStep]) -> bool {
    moves.iter().any(|step| match step {
        RecordedStep::Call(call) => {
            call.accepted && call.tool == ToolId::PostSocialMedia && !call.args["reply_to_post_id"].is_null()
        }
        RecordedStep::Parameter(_) | RecordedStep::Days(_) => false,
    })
}
