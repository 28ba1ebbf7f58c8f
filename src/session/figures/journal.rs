//! The journal: all confirmed actions, week by week, with rationales and forecasts.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::Reversal;
use novamind_tools::{Forecast, ToolId};

/// A confirmed action or week.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum JournalEntry {
    /// A tool call.
    Call {
        /// Line in the trajectory.
        seq: u64,
        /// Decision day.
        day: u32,
        /// Tool.
        tool: ToolId,
        /// Arguments.
        args: Value,
        /// The earlier call that it undid or redid.
        #[serde(flatten)]
        reversal: Option<Reversal>,
    },
    /// A parameter change in a debug run.
    Parameter {
        /// Line in the trajectory.
        seq: u64,
        /// Decision day.
        day: u32,
        /// Full key.
        key: String,
        /// Value before.
        old: Value,
        /// New value.
        new: Value,
        /// First simulated day with the new value; `None` if the change took effect immediately.
        from_day: Option<u32>,
    },
    /// A submitted week.
    Advance {
        /// Decision day.
        day: u32,
        /// Rationale.
        rationale: String,
        /// Forecasts of cash.
        forecasts: Vec<Forecast>,
        /// Whether the naive forecast filled in each forecast.
        filled_naively: [bool; 4],
    },
    /// A simulated week, or single days.
    Week {
        /// Its figures.
        figures: WeekFigures,
    },
}
