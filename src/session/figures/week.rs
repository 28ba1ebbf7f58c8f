//! Week numbers and the forecasts that a player submits for a week.

use serde_json::{Value, json};

use novamind_base::formatting::json_number;
use novamind_record::trajectory::record::SubmittedForecast;
use novamind_tools::{FORECAST_KEYS, Forecast};

/// Returns the number of the week that contains a day: 0 for day 0, 1 for days 1 to 7, 2 from day 8.
pub fn week_of_day(day: u32) -> u32 {
    day.div_ceil(7)
}

/// SQL expression for the week of a ledger row. Purchases on a decision day belong to the week that follows.
pub const LEDGER_WEEK_SQL: &str = "CASE WHEN category IN ('research_project', 'market_research', 'group_research') \
                                 THEN day / 7 + 1 ELSE (day + 6) / 7 END";

/// Returns the SQL condition that selects ledger rows of the weeks from `first` to `last`.
pub fn ledger_weeks_condition_sql(first: u32, last: u32) -> String {
    let (from, to) = (7 * first.saturating_sub(1), 7 * last);
    format!("day BETWEEN {from} AND {to} AND {LEDGER_WEEK_SQL} BETWEEN {first} AND {last}")
}

/// Four forecasts of cash, and whether each of them is a naive forecast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecasts {
    /// One forecast for each horizon: 7, 28, 84 and 182 days.
    pub all: [Forecast; 4],
    /// Whether each forecast is a naive forecast, completely or partly.
    pub filled_naively: [bool; 4],
}

/// Describes how many forecasts are naive forecasts: `by naive forecast`, `3 of 4 by naive forecast`, or `None` if no
/// forecast is naive.
pub fn describe_naive_share(filled: &[bool]) -> Option<String> {
    match filled.iter().filter(|filled| **filled).count() {
        0 => None,
        all if all == filled.len() => Some("by naive forecast".to_owned()),
        some => Some(format!("{some} of {} by naive forecast", filled.len())),
    }
}

impl Forecasts {
    /// Converts the forecasts of a line. Returns `None` unless the line has four forecasts.
    pub(crate) fn from_submitted(filed: &[SubmittedForecast]) -> Option<Forecasts> {
        let filed: &[SubmittedForecast; 4] = filed.try_into().ok()?;
        Some(Forecasts {
            all: filed.map(|forecast| forecast.to_forecast()),
            filled_naively: filed.map(|forecast| forecast.filled_naively),
        })
    }

    /// Converts the forecasts to the form in which a line records them.
    pub(crate) fn to_submitted(self) -> Vec<SubmittedForecast> {
        let one = |(forecast, filled_naively): (Forecast, bool)| {
            let Forecast { horizon_days, point, lower, upper } = forecast;
            SubmittedForecast { horizon_days, point, lower, upper, filled_naively }
        };
        self.all.into_iter().zip(self.filled_naively).map(one).collect()
    }

    /// Converts the forecasts to the `predictions` argument of `next_week`.
    pub fn to_predictions(&self) -> Value {
        let entry = |(key, forecast): (&str, &Forecast)| {
            let fields = json!({
                "point": json_number(forecast.point),
                "lower": json_number(forecast.lower),
                "upper": json_number(forecast.upper),
            });
            (key.to_owned(), fields)
        };
        FORECAST_KEYS.into_iter().zip(&self.all).map(entry).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn describe_naive_share_names_all_some_or_none() {
        let texts =
            [[false; 4], [false, true, true, true], [true; 4]].map(|filled| describe_naive_share(&filled));
        assert_eq!(
            texts,
            [None, Some("3 of 4 by naive forecast".to_owned()), Some("by naive forecast".to_owned())]
        );
    }

    #[test]
    fn week_of_day_counts_from_1_and_returns_0_for_day_0() {
        for (day, week) in [(0, 0), (1, 1), (7, 1), (8, 2), (497, 71), (500, 72), (504, 72)] {
            assert_eq!(week_of_day(day), week, "day {day}");
        }
    }
}
