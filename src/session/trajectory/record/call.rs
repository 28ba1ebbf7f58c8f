//! Calls of tools, and what came of them.

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use crate::tools::ToolId;

/// A call of a tool.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "CallFields", into = "CallFields")]
pub struct Call {
    /// Tool.
    pub tool: ToolId,
    /// Arguments: as they were understood if it was accepted, as they were sent if it was refused.
    pub args: Value,
    /// What came of it.
    pub outcome: Outcome,
    /// Where it came from.
    pub via: Via,
    /// Milliseconds it took.
    pub took_ms: f64,
    /// What it did to an earlier call.
    pub reversal: Option<Reversal>,
}

/// What came of a call.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// It was accepted, and this is the answer.
    Accepted(Value),
    /// It was refused.
    Refused(RefusalRecord),
}

/// Where an action came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Via {
    /// A form of the console.
    Form,
    /// The palette of the console.
    Palette,
    /// A line of plain mode.
    Plain,
    /// The HTTP interface.
    Http,
    /// A client of the Model Context Protocol.
    Mcp,
    /// A policy.
    Policy,
    /// A stored script.
    Script,
    /// A branch that keeps the decisions of its run.
    Branch,
    /// The file of a lesson: its start, and what it does by itself.
    Lesson,
}

/// What a call does to earlier calls of its week.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reversal {
    /// It takes back the call of this line.
    Undoes(u64),
    /// It repeats what the call of this line took back.
    Redoes(u64),
}

/// A refusal as a line has it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RefusalRecord {
    /// Code.
    pub code: String,
    /// What was wrong.
    pub message: String,
    /// Argument at fault.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field: Option<String>,
}

/// The fields of a call, in their order.
#[derive(Serialize, Deserialize)]
struct CallFields {
    tool: ToolId,
    args: Value,
    ok: bool,
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    result: Option<Value>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    refusal: Option<RefusalRecord>,
    via: Via,
    took_ms: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    undoes: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    redoes: Option<u64>,
}

impl From<CallFields> for Call {
    fn from(fields: CallFields) -> Call {
        let unnamed = || RefusalRecord { code: String::new(), message: "refused".to_owned(), field: None };
        let outcome = match fields.ok {
            true => Outcome::Accepted(fields.result.unwrap_or_default()),
            false => Outcome::Refused(fields.refusal.unwrap_or_else(unnamed)),
        };
        let redoes = fields.redoes.map(Reversal::Redoes);
        let reversal = fields.undoes.map(Reversal::Undoes).or(redoes);
        let CallFields { tool, args, via, took_ms, .. } = fields;
        Call { tool, args, outcome, via, took_ms, reversal }
    }
}

impl From<Call> for CallFields {
    fn from(call: Call) -> CallFields {
        let (ok, result, refusal) = match call.outcome {
            Outcome::Accepted(answer) => (true, Some(answer), None),
            Outcome::Refused(refusal) => (false, None, Some(refusal)),
        };
        let (undoes, redoes) = match call.reversal {
            Some(Reversal::Undoes(seq)) => (Some(seq), None),
            Some(Reversal::Redoes(seq)) => (None, Some(seq)),
            None => (None, None),
        };
        let Call { tool, args, via, took_ms, .. } = call;
        CallFields { tool, args, ok, result, refusal, via, took_ms, undoes, redoes }
    }
}

/// A field that is there, also where it is null.
fn given<'de, D: Deserializer<'de>>(field: D) -> Result<Option<Value>, D::Error> {
    Value::deserialize(field).map(Some)
}
