//! The recorded steps of a run: calls, parameter changes and simulated days.

use std::collections::BTreeMap;

use serde_json::Value;

use novamind_record::trajectory::record::{Call, JudgedPost, Outcome, Reversal, VoiceAnswer};
use novamind_record::trajectory::{Line, Record};
use novamind_session::engine::{ParameterChange, json_of_value};
use novamind_tools::{Kind, ToolId};

/// A recorded step that changed the company.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Move {
    /// A call that can change the company.
    Call(PastCall),
    /// A parameter change.
    Parameter(PastSetting),
    /// Simulated days.
    Days(PastDays),
}

/// A recorded call.
#[derive(Debug, Clone, PartialEq)]
pub struct PastCall {
    /// Its line.
    pub seq: u64,
    /// Decision day.
    pub day: u32,
    /// Tool.
    pub tool: ToolId,
    /// Arguments.
    pub args: Value,
    /// Whether it was accepted.
    pub accepted: bool,
    /// Line of the call that it undid or redid. Its settings stay even if that call is edited.
    pub reversal: Option<Reversal>,
}

/// A recorded decision.
#[derive(Debug, Clone, PartialEq)]
pub enum PastDecision {
    /// A call.
    Call(PastCall),
    /// A parameter change.
    Parameter {
        /// Its line.
        seq: u64,
        /// Decision day.
        day: u32,
        /// Full key.
        key: String,
        /// New value.
        value: Value,
        /// First day that was simulated with it; `None` if it applied immediately.
        from_day: Option<u32>,
    },
}

impl PastDecision {
    /// Its line.
    pub fn seq(&self) -> u64 {
        match self {
            PastDecision::Call(PastCall { seq, .. }) | PastDecision::Parameter { seq, .. } => *seq,
        }
    }

    /// Decision day.
    pub fn day(&self) -> u32 {
        match self {
            PastDecision::Call(PastCall { day, .. }) | PastDecision::Parameter { day, .. } => *day,
        }
    }

    /// Returns the call, or `None` for a parameter change.
    pub fn call(&self) -> Option<&PastCall> {
        match self {
            PastDecision::Call(call) => Some(call),
            PastDecision::Parameter { .. } => None,
        }
    }

    /// Describes the status: rejected, undone or redone call, or first day of a parameter. Empty for other decisions.
    pub fn remark(&self) -> String {
        match self {
            PastDecision::Call(PastCall { accepted: false, .. }) => "rejected".to_owned(),
            PastDecision::Call(PastCall { reversal: Some(Reversal::Undoes(line)), .. }) => {
                format!("undoes line {line}")
            }
            PastDecision::Call(PastCall { reversal: Some(Reversal::Redoes(line)), .. }) => {
                format!("redoes line {line}")
            }
            PastDecision::Call(_) => String::new(),
            PastDecision::Parameter { from_day, .. } => {
                from_day.map_or(String::new(), |day| format!("from day {day}"))
            }
        }
    }

    /// Returns the decision of a step, or `None` for simulated days.
    pub(crate) fn of(step: &Move) -> Option<PastDecision> {
        match step {
            Move::Call(call) => Some(PastDecision::Call(call.clone())),
            Move::Parameter(PastSetting { day, change }) => Some(PastDecision::Parameter {
                seq: change.seq,
                day: *day,
                key: change.key.clone(),
                value: json_of_value(&change.value),
                from_day: change.from_day,
            }),
            Move::Days(_) => None,
        }
    }
}

/// A recorded parameter change.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PastSetting {
    /// Day of the change.
    pub day: u32,
    /// The change.
    pub change: ParameterChange,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PastDays {
    /// Last day.
    pub until: u32,
    /// Hash of the state at the end.
    pub state_hash: String,
    /// Hash of each part of the state.
    pub parts: BTreeMap<String, String>,
    /// Scores of the player's posts by a language model.
    pub scores: Vec<JudgedPost>,
}

/// Returns the steps of events, in order.
pub(crate) fn moves(lines: &[Line]) -> Vec<Move> {
    let mut scores = Vec::new();
    lines.iter().filter_map(|line| move_of(line, &mut scores)).collect()
}

/// Returns the step of an event. Scores are kept for the days in which they apply.
fn move_of(line: &Line, scores: &mut Vec<JudgedPost>) -> Option<Move> {
    if let Some(closing) = line.record.closing() {
        let (state_hash, parts) = (closing.state_hash.clone(), closing.parts.clone());
        return Some(Move::Days(PastDays {
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
        let change = ParameterChange::of(line.seq, setting)?;
        return Some(Move::Parameter(PastSetting { day: line.day, change }));
    }
    let Record::Call(Call { tool, args, outcome, reversal, .. }) = &line.record else { return None };
    let tool = tool.known()?;
    let kind = tool.spec().kind;
    (kind.acts() && kind != Kind::Time).then(|| {
        let accepted = matches!(outcome, Outcome::Accepted(_));
        let (args, reversal) = (args.clone(), *reversal);
        Move::Call(PastCall { seq: line.seq, day: line.day, tool, args, accepted, reversal })
    })
}

/// Returns the steps after one day up to another. Decisions of a day follow that day.
pub(crate) fn between(moves: &[Move], from: u32, until: u32) -> &[Move] {
    let after = |day: u32| {
        let before = |step: &Move| match step {
            Move::Call(call) => call.day < day,
            Move::Parameter(setting) => setting.day < day,
            Move::Days(days) => days.until <= day,
        };
        moves.partition_point(before)
    };
    let (first, last) = (after(from), after(until));
    &moves[first..last.max(first)]
}

/// Whether an accepted call replies to another author's post, so that the texts of posts are needed.
pub(crate) fn has_replies(moves: &[Move]) -> bool {
    moves.iter().any(|step| match step {
        Move::Call(call) => {
            call.accepted && call.tool == ToolId::PostSocialMedia && !call.args["reply_to_post_id"].is_null()
        }
        Move::Parameter(_) | Move::Days(_) => false,
    })
}
