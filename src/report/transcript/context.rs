//! Metadata of actions: interface, duration, and the call that an action undid.

use serde_json::{Map, Value, json};

use novamind_record::trajectory::Line;
use novamind_record::trajectory::record::{QuerySource, Reversal, Via};

/// What a player knows before the first action.
#[derive(Debug, Clone, Default)]
pub struct AgentContext {
    /// Goal, rules and available calls as text.
    pub instructions: String,
    /// Definitions of the tools as functions, with the schema of their arguments.
    pub tools: Vec<Value>,
}

pub(super) fn call_metadata(via: Via, took_ms: f64) -> Map<String, Value> {
    Map::from_iter([("via".to_owned(), json!(via)), ("took_ms".to_owned(), json!(took_ms))])
}

pub(super) fn query_metadata(via: Option<QuerySource>, took_ms: f64, stopped: bool) -> Map<String, Value> {
    let mut extra = Map::from_iter([("via".to_owned(), json!(via)), ("took_ms".to_owned(), json!(took_ms))]);
    if stopped {
        extra.insert("stopped".to_owned(), true.into());
    }
    extra
}

pub(super) fn undone_call_field(reversal: Option<Reversal>) -> Option<(String, Value)> {
    reversal.map(|reversal| match reversal {
        Reversal::Undoes(seq) => ("undoes".to_owned(), seq.into()),
        Reversal::Redoes(seq) => ("redoes".to_owned(), seq.into()),
    })
}

pub(super) fn line_as_json(line: &Line) -> Value {
    let mut fields = Map::from_iter([
        ("seq".to_owned(), line.seq.into()),
        ("kind".to_owned(), line.record.kind().into()),
        ("day".to_owned(), line.day.into()),
        ("at".to_owned(), line.at.clone().into()),
    ]);
    fields.extend(line.record_fields());
    fields.into()
}
