//! Weeks: what was filed before them, what they came to, and where runs begin and end.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};

use super::call::Via;
use super::request_id::RequestId;
use super::start::Parent;
use super::{shortest, shortest_if_any};
use novamind_tools::Forecast;

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
    /// The id that the program gave the request.
    #[serde(flatten)]
    pub request: Option<RequestId>,
}

impl Advance {
    /// Whether the naive projection filled in at least one forecast; none if none was filed.
    pub fn filled_naively(&self) -> Option<bool> {
        let any = self.forecasts.iter().any(|forecast| forecast.filled_naively);
        (!self.forecasts.is_empty()).then_some(any)
    }
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
    /// Parameter, or a list or table of them: `table.key`, `group.S1.c_max_mean`.
    pub key: String,
    /// Value when it was set.
    pub old: Value,
    /// Value from here on, or from a later day.
    pub new: Value,
    /// First day that is simulated with the new value; none where it acts at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_day: Option<u32>,
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
    /// The lesson that it was played in was over.
    Lesson,
}

impl Ended {
    /// Word as trajectories write it.
    pub fn id(self) -> &'static str {
        match self {
            Ended::Horizon => "horizon",
            Ended::Bankruptcy => "bankruptcy",
            Ended::Abandoned => "abandoned",
            Ended::Lesson => "lesson",
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

/// A field that may be null, but not missing.
fn may_be_null<'de, D: Deserializer<'de>>(field: D) -> Result<Option<Parent>, D::Error> {
    Option::deserialize(field)
}

/// A calculation and what it said before the last week.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Calculated {
    /// Name.
    pub name: String,
    /// Output, cut to what the dashboard shows.
    pub output: String,
}
