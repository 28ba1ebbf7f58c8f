//! Tool calls and their outcomes.

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use super::called_tool::CalledTool;
use super::request_id::RequestId;
use novamind_tools::Rejection;

/// A recorded tool call and its outcome.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "CallFields", into = "CallFields")]
pub struct Call {
    /// Called tool, or the unknown name for which the call was rejected.
    pub tool: CalledTool,
    /// Arguments: parsed arguments of an accepted call, or unparsed arguments of a rejected call.
    pub args: Value,
    /// Result of an accepted call, or reason for a rejection.
    pub outcome: Outcome,
    /// Source of the call.
    pub via: Via,
    /// Duration of the call in milliseconds.
    pub took_ms: f64,
    /// Earlier call that this call undoes or redoes, if any.
    pub reversal: Option<Reversal>,
    /// Request id that the client sent.
    pub request: Option<RequestId>,
}

/// Outcome of a tool call.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The call was accepted and returned this result.
    Accepted(Value),
    /// The call was rejected.
    Rejected(RejectionRecord),
}

/// Source of a recorded call or week.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Via {
    /// Form of the console.
    Form,
    /// Command palette of the console.
    Palette,
    /// Input line of plain mode.
    Plain,
    /// HTTP interface.
    Http,
    /// Client of the Model Context Protocol.
    Mcp,
    /// Policy that decides the run.
    Policy,
    /// Script stored in the run.
    Script,
    /// Branch that copies the decisions of its parent run.
    Branch,
    /// Lesson file, for its initial calls and automatic actions.
    Lesson,
    /// Imported history of a game in the released simulator.
    Import,
}

/// Relation of a call to an earlier call in the same week.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reversal {
    /// The call undoes the call on the line with this number.
    Undoes(u64),
    /// The call reapplies the changes that the undo on the line with this number reverted.
    Redoes(u64),
}

/// A rejection as recorded in a line.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RejectionRecord {
    /// Error code of the rejection.
    pub code: String,
    /// Message for the user.
    pub message: String,
    /// Name of the invalid argument.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field: Option<String>,
    /// Rejection reason for each deal, if a call has several deals and all were rejected.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub results: Vec<Value>,
}

impl From<Rejection> for RejectionRecord {
    fn from(refusal: Rejection) -> RejectionRecord {
        let Rejection { code, message, field, results } = refusal;
        let results = results.iter().filter_map(|result| serde_json::to_value(result).ok()).collect();
        RejectionRecord { code: code.to_owned(), message, field, results }
    }
}

#[derive(Serialize, Deserialize)]
struct CallFields {
    tool: CalledTool,
    args: Value,
    ok: bool,
    #[serde(default, deserialize_with = "present_or_null", skip_serializing_if = "Option::is_none")]
    result: Option<Value>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    refusal: Option<RejectionRecord>,
    via: Via,
    took_ms: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    undoes: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    redoes: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    request_id: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    request_digest: Option<String>,
}

impl TryFrom<CallFields> for Call {
    type Error = String;

    fn try_from(fields: CallFields) -> Result<Call, String> {
        if let (true, CalledTool::Unknown(name)) = (fields.ok, &fields.tool) {
            return Err(format!("unknown tool `{name}` in an accepted call"));
        }
        let unnamed = || RejectionRecord { message: "refused".to_owned(), ..RejectionRecord::default() };
        let outcome = match fields.ok {
            true => Outcome::Accepted(fields.result.unwrap_or_default()),
            false => Outcome::Rejected(fields.refusal.unwrap_or_else(unnamed)),
        };
        let redoes = fields.redoes.map(Reversal::Redoes);
        let reversal = fields.undoes.map(Reversal::Undoes).or(redoes);
        let request =
            fields.request_id.zip(fields.request_digest).map(|(id, digest)| RequestId { id, digest });
        let CallFields { tool, args, via, took_ms, .. } = fields;
        Ok(Call { tool, args, outcome, via, took_ms, reversal, request })
    }
}

impl From<Call> for CallFields {
    fn from(call: Call) -> CallFields {
        let (ok, result, refusal) = match call.outcome {
            Outcome::Accepted(answer) => (true, Some(answer), None),
            Outcome::Rejected(refusal) => (false, None, Some(refusal)),
        };
        let (undoes, redoes) = match call.reversal {
            Some(Reversal::Undoes(seq)) => (Some(seq), None),
            Some(Reversal::Redoes(seq)) => (None, Some(seq)),
            None => (None, None),
        };
        let (request_id, request_digest) = call.request.map(|request| (request.id, request.digest)).unzip();
        let Call { tool, args, via, took_ms, .. } = call;
        CallFields {
            tool,
            args,
            ok,
            result,
            refusal,
            via,
            took_ms,
            undoes,
            redoes,
            request_id,
            request_digest,
        }
    }
}

/// Distinguishes a null field from a missing field.
fn present_or_null<'de, D: Deserializer<'de>>(field: D) -> Result<Option<Value>, D::Error> {
    Value::deserialize(field).map(Some)
}
