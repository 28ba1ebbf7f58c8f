//! What was done and why: every confirmed action, week by week, and how the forecasts turned out.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::trajectory::record::View;
use super::trajectory::{Durability, Record};
use super::undo::Reversal;
use super::{ForecastScore, Session, WeekFigures, filed_forecasts};
use crate::tools::{Forecast, ToolId};

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

impl Session {
    /// Everything that was done, in order.
    pub fn journal(&self) -> &[JournalEntry] {
        &self.journal
    }

    /// Scores of the forecasts so far, one per horizon.
    pub fn forecast_scores(&self) -> Vec<ForecastScore> {
        let filed = filed_forecasts(&self.journal, &self.cash_by_day);
        let horizons = self.params.limits.prediction_horizons_days.iter();
        horizons.map(|horizon| ForecastScore::of(*horizon, &filed)).collect()
    }

    /// Records what the person looked at, and for how long.
    pub fn note_view(&mut self, screen: &str, from: &str, for_ms: u64) {
        self.note(Record::View(View { screen: screen.to_owned(), from: from.to_owned(), for_ms }));
    }

    /// Records something that changes nothing; once the run is over nothing more is recorded.
    pub(super) fn note(&mut self, record: Record) {
        if self.ended.is_none() {
            // Nothing is lost with it, so a disk that refuses it is no reason to stop.
            let _ = self.append(&record, Durability::Written);
        }
    }
}
