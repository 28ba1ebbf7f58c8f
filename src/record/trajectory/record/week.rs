//! Weeks, overrides, branches and ends of runs.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};

use super::call::Via;
use super::request_id::RequestId;
use super::start::Parent;
use super::{serialize_shortest, serialize_shortest_option};
use novamind_tools::Forecast;

/// The submission before a week.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Advance {
    /// Rationale.
    pub rationale: String,
    /// Forecasts of cash, one for each horizon.
    pub forecasts: Vec<FiledForecast>,
    /// Source.
    pub via: Via,
    /// Outputs of the registered calculations.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub calculations: Vec<CalculationOutput>,
    /// Request id that the client sent.
    #[serde(flatten)]
    pub request: Option<RequestId>,
}

impl Advance {
    /// Returns whether at least one forecast was filled in naively, or `None` without forecasts.
    pub fn has_naive_forecasts(&self) -> Option<bool> {
        let any = self.forecasts.iter().any(|forecast| forecast.filled_naively);
        (!self.forecasts.is_empty()).then_some(any)
    }
}

/// A forecast in a line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FiledForecast {
    /// Days ahead.
    pub horizon_days: u32,
    /// Most likely value, dollars.
    #[serde(serialize_with = "serialize_shortest")]
    pub point: f64,
    /// Lower end of the 95 % interval, dollars.
    #[serde(serialize_with = "serialize_shortest")]
    pub lower: f64,
    /// Upper end of the 95 % interval, dollars.
    #[serde(serialize_with = "serialize_shortest")]
    pub upper: f64,
    /// Whether a naive forecast filled it in, completely or partly.
    #[serde(default)]
    pub filled_naively: bool,
}

impl FiledForecast {
    /// Returns the forecast.
    pub fn to_forecast(self) -> Forecast {
        let FiledForecast { horizon_days, point, lower, upper, .. } = self;
        Forecast { horizon_days, point, lower, upper }
    }
}

/// Simulated days and the state after them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Closing {
    /// Number of days.
    pub days_run: u32,
    /// Figures by name.
    pub figures: Map<String, Value>,
    /// Cash after them, dollars.
    #[serde(serialize_with = "serialize_shortest")]
    pub cash: f64,
    /// State hash.
    pub state_hash: String,
    /// Prefixes of the hashes of the state's parts.
    pub parts: BTreeMap<String, String>,
}

/// A change of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Override {
    /// Key of a parameter, or of a list or table of parameters: `table.key`, `group.S1.c_max_mean`.
    pub key: String,
    /// Value before the change.
    pub old: Value,
    /// New value.
    pub new: Value,
    /// First day that is simulated with the new value; `None` if it acts at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_day: Option<u32>,
}

/// Origin of a branch.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Branch {
    /// Parent run and its last copied line.
    #[serde(deserialize_with = "required_nullable")]
    pub from: Option<Parent>,
}

/// Reason of the end of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunEndReason {
    /// The last day was reached.
    Horizon,
    /// Cash fell below zero.
    Bankruptcy,
    /// The user abandoned the run.
    Abandoned,
    /// The lesson of the run was over.
    Lesson,
}

impl RunEndReason {
    /// Returns the name in trajectories.
    pub fn id(self) -> &'static str {
        match self {
            RunEndReason::Horizon => "horizon",
            RunEndReason::Bankruptcy => "bankruptcy",
            RunEndReason::Abandoned => "abandoned",
            RunEndReason::Lesson => "lesson",
        }
    }
}

/// The end of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// Reason.
    pub reason: RunEndReason,
    /// Cash, dollars.
    #[serde(serialize_with = "serialize_shortest")]
    pub cash: f64,
    /// Score; `None` for an abandoned run or a lesson.
    #[serde(serialize_with = "serialize_shortest_option")]
    pub score: Option<f64>,
}

/// Accepts null, but not a missing field.
fn required_nullable<'de, D: Deserializer<'de>>(field: D) -> Result<Option<Parent>, D::Error> {
    Option::deserialize(field)
}

/// The output of a calculation before a week.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CalculationOutput {
    /// Name.
    pub name: String,
    /// Output, cut to what the dashboard shows.
    pub output: String,
}
