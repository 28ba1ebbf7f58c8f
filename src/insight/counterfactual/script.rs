//! What was done in a run and how its days passed, line by line.

use std::collections::BTreeMap;

use serde_json::Value;

use novamind_record::trajectory::record::{Call, JudgedPost, Outcome, Reversal, VoiceAnswer};
use novamind_record::trajectory::{Line, Record};
use novamind_session::engine::{ParameterChange, json_of_value};
use novamind_tools::{Kind, ToolId};

/// Something that moved the company on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Move {
    /// A call that could act on the company.
    Call(PastCall),
    /// A parameter was set.
    Parameter(PastSetting),
    /// Days passed.
    Days(PastDays),
}

/// A call of the past.
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
    /// The call that it undid or redid; what it sets stays, whatever becomes of that one.
    pub reversal: Option<Reversal>,
}

/// Something that was decided in the past.
#[derive(Debug, Clone, PartialEq)]
pub enum PastDecision {
    /// A call.
    Call(PastCall),
    /// A parameter that was set.
    Parameter {
        /// Its line.
        seq: u64,
        /// Decision day.
        day: u32,
        /// Full key.
        key: String,
        /// Value that it was set to.
        value: Value,
        /// First day that was simulated with it; none: it acted at once.
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

    /// The call that it is.
    pub fn call(&self) -> Option<&PastCall> {
        match self {
            PastDecision::Call(call) => Some(call),
            PastDecision::Parameter { .. } => None,
        }
    }

    /// What is to be said of it: that it was refused, what it undid, or since when it acts; nothing of most.
    pub fn remark(&self) -> String {
        match self {
            PastDecision::Call(PastCall { accepted: false, .. }) => "refused".to_owned(),
            PastDecision::Call(PastCall { reversal: Some(Reversal::Undoes(line)), .. }) => {
                format!("undoes line {line}")
            }
            PastDecision::Call(PastCall { reversal: Some(Reversal::Redoes(line)), .. }) => {
                format!("redoes line {line}")
            }
            PastDecision::Call(_) => String::new(),
            PastDecision::Parameter { from_day, .. } => {
                from_day.map_or(String::new(), |day| format!("from day {day} on"))
            }
        }
    }

    /// What a move decided; none where days passed.
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

/// A parameter that was set in the past.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PastSetting {
    /// Day on which it was set.
    pub day: u32,
    /// What was set.
    pub change: ParameterChange,
}

/// Days of the past.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PastDays {
    /// The last of them.
    pub until: u32,
    /// Hash of the state they led to.
    pub state_hash: String,
    /// Hash of each part of it.
    pub parts: BTreeMap<String, String>,
    /// What a language model made of the player's posts on the way.
    pub scores: Vec<JudgedPost>,
}

/// The moves of some lines, in their order.
pub(crate) fn moves(lines: &[Line]) -> Vec<Move> {
    let mut scores = Vec::new();
    lines.iter().filter_map(|line| move_of(line, &mut scores)).collect()
}

/// The move of a line; scores wait for the days in which they count.
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

/// Those moves that follow a day and lead no further than another; what is decided on a day follows it.
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

/// Whether an accepted call answers a post of somebody else: then the words of posts matter.
pub(crate) fn has_replies(moves: &[Move]) -> bool {
    moves.iter().any(|step| match step {
        Move::Call(call) => {
            call.accepted && call.tool == ToolId::PostSocialMedia && !call.args["reply_to_post_id"].is_null()
        }
        Move::Parameter(_) | Move::Days(_) => false,
    })
}
