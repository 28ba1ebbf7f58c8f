//! What was done and why: every confirmed action, week by week, and how the forecasts turned out.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::trajectory::record::View;
use super::trajectory::{Durability, Record};
use super::undo::Reversal;
use super::{Filed, Session, WeekFigures, filed_forecasts};
use crate::tools::Forecast;

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
        tool: String,
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
        /// Some of them were filled in by the naive projection.
        filled_naively: bool,
    },
    /// A week, or single days, ran.
    Week {
        /// Its figures.
        figures: WeekFigures,
    },
}

/// How well forecasts of one horizon did so far (chapter 60 §7).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ForecastScore {
    /// Days ahead.
    pub horizon_days: u32,
    /// Forecasts whose day has come.
    pub scored: u32,
    /// Those whose interval held the outcome.
    pub covered: u32,
    /// Mean of |point - outcome| / |outcome|.
    pub mean_error: f64,
    /// Mean of (upper - lower) / |outcome|.
    pub mean_sharpness: f64,
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
        horizons.map(|horizon| Session::score_horizon(*horizon, &filed)).collect()
    }

    fn score_horizon(horizon_days: u32, filed: &[Filed]) -> ForecastScore {
        let mut score =
            ForecastScore { horizon_days, scored: 0, covered: 0, mean_error: 0.0, mean_sharpness: 0.0 };
        for forecast in filed.iter().filter(|filed| filed.horizon_days == horizon_days) {
            let Some(outcome) = forecast.outcome else { continue };
            let size = if outcome.abs() <= 1.0 { 1.0 } else { outcome.abs() };
            score.scored += 1;
            score.covered += u32::from(forecast.is_inside());
            score.mean_error += (forecast.point - outcome).abs() / size;
            score.mean_sharpness += (forecast.upper - forecast.lower) / size;
        }
        let count = f64::from(score.scored.max(1));
        (score.mean_error, score.mean_sharpness) = (score.mean_error / count, score.mean_sharpness / count);
        score
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
