//! What a line of a trajectory says, by its kind (format 1).
//!
//! Fields stand in the order in which they are written. A field that this version does not know is no error; a line keeps
//! its text, so that a copy of it loses nothing.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};
use toml::Table;

use crate::notation::json_number;
use crate::session::folder::consent::Consent;
use crate::session::folder::mode::Mode;
use crate::session::play::surroundings::Calculated;
use crate::tools::{Forecast, ToolId};

/// What a line says.
#[derive(Debug, Clone, PartialEq)]
pub enum Record {
    /// The first line: what the run is.
    Start(Box<Start>),
    /// A tool was called.
    Call(Call),
    /// The database was asked.
    Query(Query),
    /// A screen was looked at.
    View(View),
    /// The notes were kept.
    Memo(Memo),
    /// Rationale and forecasts were filed, and the week was let pass.
    Advance(Advance),
    /// A week has passed.
    Week(Closing),
    /// Single days of a debug run have passed.
    Step(Closing),
    /// A parameter was changed in a debug run.
    Override(Override),
    /// The run began as a branch of another.
    Branch(Branch),
    /// The run was over.
    End(End),
    /// A kind that this version does not know, by its name.
    Unknown(String),
}

/// What the first line says of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Format of the trajectory.
    pub format: u32,
    /// Version that recorded the run.
    pub version: String,
    /// Number of the mechanics.
    #[serde(default = "first_mechanics")]
    pub mechanics: u32,
    /// Run.
    pub run: String,
    /// Seed.
    pub seed: u64,
    /// Last day.
    pub days: u32,
    /// Cash on day 0, dollars.
    #[serde(serialize_with = "shortest")]
    pub cash: f64,
    /// Scenario.
    pub scenario: String,
    /// Parameters that differ from the shipped ones.
    #[serde(default)]
    pub overrides: Table,
    /// Digest of the effective parameters.
    pub parameters_digest: String,
    /// Mode.
    pub mode: Mode,
    /// Who plays, as the experimenter names them.
    pub participant: Option<String>,
    /// Which text was agreed to, and when.
    #[serde(default)]
    pub consent: Option<Consent>,
    /// Where a branch comes from.
    pub parent: Option<Parent>,
    /// Whether every line ends with a sum; those of the first builds do not.
    #[serde(default)]
    pub line_sums: bool,
}

/// Where a branch comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parent {
    /// Run.
    pub run: String,
    /// Number of the last line that was copied.
    pub seq: u64,
}

/// Number of the mechanics of runs whose first line names none.
pub(crate) fn first_mechanics() -> u32 {
    1
}

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
    /// A policy.
    Policy,
    /// A stored script.
    Script,
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

/// A question to the database.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Query {
    /// Statement.
    pub sql: String,
    /// Rows of the answer; none if there is none.
    pub rows: Option<u64>,
    /// There were more rows than are shown.
    pub truncated: bool,
    /// Code of what was wrong.
    pub error: Option<String>,
    /// Milliseconds it took.
    pub took_ms: f64,
}

/// A look at a screen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct View {
    /// Screen.
    pub screen: String,
    /// Screen before it.
    pub from: String,
    /// Milliseconds.
    pub for_ms: u64,
}

/// The notes as they were kept; their text is in a file of its own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memo {
    /// blake3 digest of the text, in hexadecimal digits.
    pub digest: String,
    /// Bytes of the text.
    pub length: u64,
}

/// What was filed before a week.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Advance {
    /// Why.
    pub rationale: String,
    /// Forecasts of cash, one for each horizon.
    pub forecasts: Vec<FiledForecast>,
    /// Where it came from.
    pub via: Via,
    /// What the registered calculations said.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub calculations: Vec<Calculated>,
}

/// A forecast as a line has it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FiledForecast {
    /// Days ahead.
    pub horizon_days: u32,
    /// Most likely value, dollars.
    #[serde(serialize_with = "shortest")]
    pub point: f64,
    /// Lower end of the 95 % interval, dollars.
    #[serde(serialize_with = "shortest")]
    pub lower: f64,
    /// Upper end of the 95 % interval, dollars.
    #[serde(serialize_with = "shortest")]
    pub upper: f64,
    /// Filled in by the naive projection, whole or in part.
    #[serde(default)]
    pub filled_naively: bool,
}

impl FiledForecast {
    /// What was said.
    pub fn said(self) -> Forecast {
        let FiledForecast { horizon_days, point, lower, upper, .. } = self;
        Forecast { horizon_days, point, lower, upper }
    }
}

/// Days that have passed, and the state after them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Closing {
    /// How many.
    pub days_run: u32,
    /// Figures by name.
    pub figures: Map<String, Value>,
    /// Cash after them, dollars.
    #[serde(serialize_with = "shortest")]
    pub cash: f64,
    /// Hash of the state.
    pub state_hash: String,
    /// Beginnings of the hashes of its parts.
    pub parts: BTreeMap<String, String>,
}

/// A change of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Override {
    /// Parameter, `table.key`.
    pub key: String,
    /// Value before.
    pub old: Value,
    /// Value from here on.
    pub new: Value,
}

/// Where a branch comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Branch {
    /// The other run and its last line that was copied.
    #[serde(deserialize_with = "may_be_null")]
    pub from: Option<Parent>,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ended {
    /// It reached its last day.
    Horizon,
    /// Cash fell below zero.
    Bankruptcy,
    /// Somebody gave it up.
    Abandoned,
}

impl Ended {
    /// Word as trajectories write it.
    pub fn id(self) -> &'static str {
        match self {
            Ended::Horizon => "horizon",
            Ended::Bankruptcy => "bankruptcy",
            Ended::Abandoned => "abandoned",
        }
    }
}

/// The end of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// Why.
    pub reason: Ended,
    /// Cash, dollars.
    #[serde(serialize_with = "shortest")]
    pub cash: f64,
    /// Score; none for a run that was given up.
    #[serde(serialize_with = "shortest_if_any")]
    pub score: Option<f64>,
}

impl Record {
    /// Name of the kind.
    pub fn kind(&self) -> &str {
        match self {
            Record::Start(_) => "start",
            Record::Call(_) => "call",
            Record::Query(_) => "query",
            Record::View(_) => "view",
            Record::Memo(_) => "memo",
            Record::Advance(_) => "advance",
            Record::Week(_) => "week",
            Record::Step(_) => "step",
            Record::Override(_) => "override",
            Record::Branch(_) => "branch",
            Record::End(_) => "end",
            Record::Unknown(kind) => kind,
        }
    }

    /// Reads a line of a kind.
    pub(super) fn read(kind: &str, line: &[u8]) -> serde_json::Result<Record> {
        Ok(match kind {
            "start" => Record::Start(serde_json::from_slice(line)?),
            "call" => Record::Call(serde_json::from_slice(line)?),
            "query" => Record::Query(serde_json::from_slice(line)?),
            "view" => Record::View(serde_json::from_slice(line)?),
            "memo" => Record::Memo(serde_json::from_slice(line)?),
            "advance" => Record::Advance(serde_json::from_slice(line)?),
            "week" => Record::Week(serde_json::from_slice(line)?),
            "step" => Record::Step(serde_json::from_slice(line)?),
            "override" => Record::Override(serde_json::from_slice(line)?),
            "branch" => Record::Branch(serde_json::from_slice(line)?),
            "end" => Record::End(serde_json::from_slice(line)?),
            other => Record::Unknown(other.to_owned()),
        })
    }

    /// Its fields, in their order.
    pub(super) fn fields(&self) -> Map<String, Value> {
        let fields = match self {
            Record::Start(start) => serde_json::to_value(start),
            Record::Call(call) => serde_json::to_value(call),
            Record::Query(query) => serde_json::to_value(query),
            Record::View(view) => serde_json::to_value(view),
            Record::Memo(memo) => serde_json::to_value(memo),
            Record::Advance(advance) => serde_json::to_value(advance),
            Record::Week(closing) | Record::Step(closing) => serde_json::to_value(closing),
            Record::Override(change) => serde_json::to_value(change),
            Record::Branch(branch) => serde_json::to_value(branch),
            Record::End(end) => serde_json::to_value(end),
            Record::Unknown(_) => Ok(Value::Null),
        };
        match fields {
            Ok(Value::Object(fields)) => fields,
            // Records hold nothing that JSON does not know.
            _ => Map::new(),
        }
    }

    /// The days it closes, if it closes some.
    pub fn closing(&self) -> Option<&Closing> {
        match self {
            Record::Week(closing) | Record::Step(closing) => Some(closing),
            _ => None,
        }
    }

    /// The call and its answer, if it is one that was accepted.
    pub fn accepted_call(&self) -> Option<(&Call, &Value)> {
        match self {
            Record::Call(call @ Call { outcome: Outcome::Accepted(answer), .. }) => Some((call, answer)),
            _ => None,
        }
    }
}

/// A field that is there, also where it is null.
fn given<'de, D: Deserializer<'de>>(field: D) -> Result<Option<Value>, D::Error> {
    Value::deserialize(field).map(Some)
}

/// A field that may be null, but not missing.
fn may_be_null<'de, D: Deserializer<'de>>(field: D) -> Result<Option<Parent>, D::Error> {
    Option::deserialize(field)
}

/// Whole amounts without a decimal point.
fn shortest<S: Serializer>(number: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    json_number(*number).serialize(serializer)
}

fn shortest_if_any<S: Serializer>(number: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    number.map(json_number).serialize(serializer)
}
