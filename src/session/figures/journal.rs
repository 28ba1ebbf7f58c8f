//! The journal: all confirmed actions, week by week, with rationales and forecasts.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::Reversal;
use novamind_tools::{Forecast, ToolId};

/// An entry of the journal: a confirmed action or a simulated week.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum JournalEntry {
    /// An accepted tool call.
    Call {
        /// Number of the line in the trajectory.
        seq: u64,
        /// Decision day.
        day: u32,
        /// Tool that was called.
        tool: ToolId,
        /// Arguments of the call.
        args: Value,
        /// Earlier call that this call undid or redid, if any.
        #[serde(flatten)]
        reversal: Option<Reversal>,
    },
    /// A parameter change in a debug run.
    Parameter {
        /// Number of the line in the trajectory.
        seq: u64,
        /// Decision day.
        day: u32,
        /// Full key of the parameter.
        key: String,
        /// Value before the change.
        old: Value,
        /// Value after the change.
        new: Value,
        /// First simulated day with the new value; `None` if the change took effect immediately.
        from_day: Option<u32>,
    },
    /// The submission before a week.
    Advance {
        /// Decision day.
        day: u32,
        /// Rationale of the week.
        rationale: String,
        /// Forecasts of cash, one per horizon.
        forecasts: Vec<Forecast>,
        /// Whether each forecast is a naive forecast, completely or partly.
        filled_naively: [bool; 4],
    },
    /// A simulated week, or single simulated days.
    Week {
        /// Figures of the simulated days.
        figures: WeekFigures,
    },
}
