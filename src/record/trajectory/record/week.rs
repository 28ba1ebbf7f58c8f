//! Weeks, overrides, branches and ends of runs.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};

use super::call::Via;
use super::request_id::RequestId;
use super::start::Parent;
use super::{serialize_shortest, serialize_shortest_option};
use novamind_tools::Forecast;

/// The player's submission before a week is simulated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Advance {
    /// The player's reasons for the decisions of the week.
    pub rationale: String,
    /// Forecasts of cash, one forecast for each horizon.
    pub forecasts: Vec<SubmittedForecast>,
    /// Source of the submission.
    pub via: Via,
    /// Outputs of the registered calculations before the week.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub calculations: Vec<CalculationOutput>,
    /// Request id that the client sent.
    #[serde(flatten)]
    pub request: Option<RequestId>,
}

/// Returns whether at least one submitted forecast that ends within the run is a naive forecast, or `None` if there are
/// no forecasts. `days_left` is the number of days from the submission to the last day of the run.
pub fn has_naive_forecasts(forecasts: &[SubmittedForecast], days_left: u32) -> Option<bool> {
    let all = forecasts.iter().map(|forecast| (forecast.horizon_days, forecast.filled_naively));
    (!forecasts.is_empty()).then(|| is_naive_week(all, days_left))
}

/// Returns whether at least one forecast that ends within the run is a naive forecast. The iterator yields the horizon
/// of each forecast in days, and whether the forecast is naive. The program fills in forecasts that end after the last
/// day, so these count only if no forecast ends within the run.
pub fn is_naive_week(forecasts: impl Iterator<Item = (u32, bool)> + Clone, days_left: u32) -> bool {
    let ends_within_run = |forecast: &(u32, bool)| forecast.0 <= days_left;
    let any_ends_within_run = forecasts.clone().any(|forecast| ends_within_run(&forecast));
    forecasts
        .filter(|forecast| ends_within_run(forecast) || !any_ends_within_run)
        .any(|(_, is_naive)| is_naive)
}

/// A submitted forecast as recorded in a line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SubmittedForecast {
    /// Days from the submission to the target of the forecast.
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
    /// Whether values of the naive forecast were submitted, completely or partly.
    #[serde(default)]
    pub filled_naively: bool,
}

impl SubmittedForecast {
    /// Returns the forecast without the information on how it was entered.
    pub fn to_forecast(self) -> Forecast {
        let SubmittedForecast { horizon_days, point, lower, upper, .. } = self;
        Forecast { horizon_days, point, lower, upper }
    }
}

/// Figures of simulated days, and the state after these days.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClosedDays {
    /// Number of simulated days.
    pub days_run: u32,
    /// Visible figures of the simulated days, by JSON key.
    pub figures: Map<String, Value>,
    /// Cash after the simulated days, dollars.
    #[serde(serialize_with = "serialize_shortest")]
    pub cash: f64,
    /// Hash of the complete simulator state.
    pub state_hash: String,
    /// First digits of the hash of each part of the state, by name of the part.
    pub parts: BTreeMap<String, String>,
}

/// A parameter change in a debug run or a lesson.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Override {
    /// Key of a parameter, a list or a table of parameters, for instance `group.S1.c_max_mean`.
    pub key: String,
    /// Value before the change.
    pub old: Value,
    /// Value after the change.
    pub new: Value,
    /// First day that is simulated with the new value; `None` if the change takes effect at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_day: Option<u32>,
}

/// The event after the copied lines of a branch.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Branch {
    /// Parent run and last copied line.
    #[serde(deserialize_with = "required_nullable")]
    pub from: Option<Parent>,
}

/// The reason for the end of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunEndReason {
    /// The last day was reached.
    Horizon,
    /// Cash fell below zero.
    Bankruptcy,
    /// The user abandoned the run.
    Abandoned,
    /// The last step of the lesson ended.
    Lesson,
}

impl RunEndReason {
    /// Returns the name that trajectories use for the reason.
    pub fn id(self) -> &'static str {
        match self {
            RunEndReason::Horizon => "horizon",
            RunEndReason::Bankruptcy => "bankruptcy",
            RunEndReason::Abandoned => "abandoned",
            RunEndReason::Lesson => "lesson",
        }
    }
}

/// The event at the end of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// Reason for the end of the run.
    pub reason: RunEndReason,
    /// Cash at the end of the run, dollars.
    #[serde(serialize_with = "serialize_shortest")]
    pub cash: f64,
    /// Score of the run; `None` for an abandoned run or a lesson.
    #[serde(serialize_with = "serialize_shortest_option")]
    pub score: Option<f64>,
}

/// Accepts a null field and rejects a missing field.
fn required_nullable<'de, D: Deserializer<'de>>(field: D) -> Result<Option<Parent>, D::Error> {
    Option::deserialize(field)
}

/// The output of a calculation before a week.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CalculationOutput {
    /// Name under which the player registered the calculation.
    pub name: String,
    /// Output of the calculation, truncated to the length that the dashboard shows.
    pub output: String,
}

#[cfg(test)]
mod tests {
    use super::is_naive_week;

    #[test]
    fn naive_forecasts_beyond_the_last_day_do_not_count() {
        let filled = |naive: [bool; 4]| [7, 28, 84, 182].into_iter().zip(naive);
        assert!(!is_naive_week(filled([false, false, true, true]), 83));
        assert!(is_naive_week(filled([false, false, true, true]), 84));
        assert!(is_naive_week(filled([true; 4]), 3), "no forecast ends within the run");
        assert!(!is_naive_week(filled([false; 4]), 500));
    }
}
