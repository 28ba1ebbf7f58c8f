//! What was done and why: every confirmed action, week by week, and how the forecasts turned out.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::Reversal;
use novamind_tools::{Forecast, ToolId};

/// A confirmed action or week.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum JournalEntry {
    /// A tool was called.
    Call {
        /// Its line in the trajectory.
        seq: u64,
        /// Decision day.
        day: u32,
        /// Tool.
        tool: ToolId,
        /// Arguments.
        args: Value,
        /// What it did to an earlier call.
        #[serde(flatten)]
        reversal: Option<Reversal>,
    },
    /// A parameter of a debug run was set.
    Parameter {
        /// Its line in the trajectory.
        seq: u64,
        /// Decision day.
        day: u32,
        /// Full key.
        key: String,
        /// Value before.
        old: Value,
        /// Value from then on.
        new: Value,
        /// First day that is simulated with it; none: it acted at once.
        from_day: Option<u32>,
    },
    /// A week was let pass.
    Advance {
        /// Decision day.
        day: u32,
        /// Why.
        rationale: String,
        /// Forecasts of cash.
        forecasts: Vec<Forecast>,
        /// Which of them the naive projection filled in.
        filled_naively: [bool; 4],
    },
    /// A week, or single days, ran.
    Week {
        /// Its figures.
        figures: WeekFigures,
    },
}
