//! Submitted forecasts and their outcomes: due day, coverage and error.

use serde::Serialize;

use super::journal::JournalEntry;
use novamind_base::formatting::percent;
use novamind_record::figures::WeekFigures;
use novamind_tools::Forecast;

/// A submitted forecast of cash, with the outcome if the forecast is due.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ScoredForecast {
    /// Forecast as submitted.
    #[serde(flatten)]
    pub forecast: Forecast,
    /// Day on which the forecast was submitted.
    #[serde(skip)]
    pub day: u32,
    /// Actual cash on the due day, dollars; `None` before the due day.
    pub outcome: Option<f64>,
}

/// Position of an outcome relative to an interval, which includes its endpoints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IntervalPosition {
    /// The outcome is below the lower end of the interval.
    Below,
    /// The outcome is within the interval.
    Inside,
    /// The outcome is above the upper end of the interval.
    Above,
}

impl IntervalPosition {
    /// Returns the position as a word, for output.
    pub fn as_str(self) -> &'static str {
        match self {
            IntervalPosition::Below => "below",
            IntervalPosition::Inside => "inside",
            IntervalPosition::Above => "above",
        }
    }
}

impl ScoredForecast {
    /// Creates a scored forecast that was submitted on `day`. The outcome is the cash at the end of the week that ends
    /// on the due day, before purchases that follow on the same day.
    pub fn new(day: u32, forecast: &Forecast, weeks: &[WeekFigures]) -> ScoredForecast {
        let scored = ScoredForecast { forecast: *forecast, day, outcome: None };
        ScoredForecast { outcome: cash_at_week_end(weeks, scored.due_day()), ..scored }
    }

    /// Returns the day on which the forecast is due.
    pub fn due_day(&self) -> u32 {
        self.day.saturating_add(self.forecast.horizon_days)
    }

    /// Returns the position of the outcome relative to the interval, or `None` before the due day.
    pub fn interval_position(&self) -> Option<IntervalPosition> {
        let outcome = self.outcome?;
        Some(if outcome < self.forecast.lower {
            IntervalPosition::Below
        } else if outcome > self.forecast.upper {
            IntervalPosition::Above
        } else {
            IntervalPosition::Inside
        })
    }

    /// Returns whether the interval contains the outcome. Returns false before the due day.
    pub fn is_covered(&self) -> bool {
        self.interval_position() == Some(IntervalPosition::Inside)
    }

    /// Returns the forecast error as a share of the outcome, or of 1 dollar if the outcome is smaller. The error is
    /// positive if the predicted value was too high.
    pub fn relative_error(&self) -> Option<f64> {
        self.outcome.map(|outcome| (self.forecast.point - outcome) / error_scale(outcome))
    }

    /// Describes the forecast error, for example `0.2% low`, or `within 0.1%` if the rounded error is 0. Returns `None`
    /// before the due day. Errors of 1,000 % or more are shown as `>999%`.
    pub fn describe_error(&self) -> Option<String> {
        let error = self.relative_error()?;
        let shown = match error.abs() {
            size if size < 10.0 => percent(size, 1),
            _ => ">999%".to_owned(),
        };
        Some(match error {
            _ if shown == percent(0.0, 1) => "within 0.1%".to_owned(),
            error if error < 0.0 => format!("{shown} low"),
            _ => format!("{shown} high"),
        })
    }

    /// Returns the width of the interval as a share of the outcome, or `None` before the due day.
    pub fn sharpness(&self) -> Option<f64> {
        self.outcome.map(|outcome| (self.forecast.upper - self.forecast.lower) / error_scale(outcome))
    }
}

/// Returns the cash at the end of the week that ends on a day, before purchases that follow on the same day.
pub fn cash_at_week_end(weeks: &[WeekFigures], day: u32) -> Option<f64> {
    weeks.binary_search_by_key(&day, |week| week.day).ok().map(|at| weeks[at].cash)
}

fn error_scale(outcome: f64) -> f64 {
    outcome.abs().max(1.0)
}

/// Returns all submitted forecasts in order, with their outcomes.
pub fn submitted_forecasts(journal: &[JournalEntry], weeks: &[WeekFigures]) -> Vec<ScoredForecast> {
    let mut all = Vec::new();
    for entry in journal {
        let JournalEntry::Advance { day, forecasts, .. } = entry else { continue };
        all.extend(forecasts.iter().map(|forecast| ScoredForecast::new(*day, forecast, weeks)));
    }
    all
}

/// The score of all forecasts with the same horizon.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ForecastScore {
    /// Horizon of the forecasts, in days.
    pub horizon_days: u32,
    /// Number of forecasts that came due.
    pub scored: u32,
    /// Number of forecasts whose interval contains the outcome.
    pub covered: u32,
    /// Mean absolute forecast error, as a share of the outcome.
    pub mean_error: f64,
    /// Mean width of the interval, as a share of the outcome.
    pub mean_sharpness: f64,
}

impl ForecastScore {
    /// Computes the score of a horizon from all submitted forecasts.
    pub fn from_forecasts(horizon_days: u32, filed: &[ScoredForecast]) -> ForecastScore {
        let due = filed.iter().filter(|one| one.forecast.horizon_days == horizon_days);
        let due: Vec<&ScoredForecast> = due.filter(|one| one.outcome.is_some()).collect();
        let mean = |of: fn(&ScoredForecast) -> Option<f64>| {
            due.iter().filter_map(|one| of(one)).map(f64::abs).sum::<f64>() / due.len().max(1) as f64
        };
        ForecastScore {
            horizon_days,
            scored: due.len() as u32,
            covered: due.iter().filter(|one| one.is_covered()).count() as u32,
            mean_error: mean(ScoredForecast::relative_error),
            mean_sharpness: mean(ScoredForecast::sharpness),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn forecast_with_outcome(outcome: f64) -> ScoredForecast {
        let forecast = Forecast { horizon_days: 7, point: 5.0, lower: 1.0, upper: 9.0 };
        ScoredForecast { forecast, day: 7, outcome: Some(outcome) }
    }

    #[test]
    fn interval_includes_its_endpoints() {
        use IntervalPosition::{Above, Below, Inside};
        let verdicts =
            [0.9, 1.0, 5.0, 9.0, 9.1].map(|outcome| forecast_with_outcome(outcome).interval_position());
        assert_eq!(verdicts, [Below, Inside, Inside, Inside, Above].map(Some));
        let open = ScoredForecast { outcome: None, ..forecast_with_outcome(5.0) };
        assert_eq!(
            (open.interval_position(), open.is_covered(), open.relative_error(), open.due_day()),
            (None, false, None, 14)
        );
    }

    #[test]
    fn describe_error_returns_low_high_or_within_a_tenth() {
        let texts = [10.0, 4.0, 5.001, 5.0, 4.999, 0.0, 0.2]
            .map(|outcome| forecast_with_outcome(outcome).describe_error());
        let descriptions = texts.each_ref().map(|text| text.as_deref().unwrap_or_default());
        assert_eq!(
            descriptions,
            [
                "50.0% low",
                "25.0% high",
                "within 0.1%",
                "within 0.1%",
                "within 0.1%",
                "500.0% high",
                "480.0% high"
            ]
        );
        let far = Forecast { point: -50.0, ..forecast_with_outcome(1.0).forecast };
        let far = ScoredForecast { forecast: far, ..forecast_with_outcome(1.0) };
        assert_eq!(far.describe_error().as_deref(), Some(">999% low"));
    }

    #[test]
    fn relative_error_uses_outcome_or_one_dollar() {
        assert_eq!(
            [4.0, -10.0, 0.0].map(|outcome| forecast_with_outcome(outcome).relative_error()),
            [0.25, 1.5, 5.0].map(Some)
        );
        let score = ForecastScore::from_forecasts(
            7,
            &[
                forecast_with_outcome(4.0),
                forecast_with_outcome(10.0),
                ScoredForecast { outcome: None, ..forecast_with_outcome(1.0) },
            ],
        );
        assert_eq!((score.scored, score.covered), (2, 1));
        assert!((score.mean_error - (0.25 + 0.5) / 2.0).abs() < 1e-12);
        assert!((score.mean_sharpness - (8.0 / 4.0 + 8.0 / 10.0) / 2.0).abs() < 1e-12);
        assert_eq!(ForecastScore::from_forecasts(28, &[forecast_with_outcome(4.0)]).scored, 0);
    }

    #[test]
    fn outcome_is_the_cash_at_the_end_of_the_due_week() {
        let week = |day: u32| WeekFigures { day, cash: f64::from(10 * day), ..WeekFigures::default() };
        let weeks = [week(7), week(14)];
        let one = ScoredForecast::new(7, &forecast_with_outcome(0.0).forecast, &weeks);
        assert_eq!((one.due_day(), one.outcome), (14, Some(140.0)));
        assert_eq!(ScoredForecast::new(14, &one.forecast, &weeks).outcome, None);
    }
}
