//! Week numbers and the forecasts that a player submits for a week.

use serde_json::{Value, json};

use novamind_base::formatting::json_number;
use novamind_record::trajectory::record::FiledForecast;
use novamind_tools::{FORECAST_KEYS, Forecast};

/// Returns the week of a day: 0 -> 0, 1 to 7 -> 1, 8 -> 2.
pub fn week_of(day: u32) -> u32 {
    day.div_ceil(7)
}

/// SQL expression for the week of a ledger row. Purchases on a decision day belong to the week that starts with it.
pub const WEEK_OF_ENTRY_SQL: &str = "CASE WHEN category IN ('research_project', 'market_research', 'group_research') \
                                 THEN day / 7 + 1 ELSE (day + 6) / 7 END";

/// Returns the SQL condition for ledger rows of some weeks.
pub fn entries_of_weeks_sql(first: u32, last: u32) -> String {
    let (from, to) = (7 * first.saturating_sub(1), 7 * last);
    format!("day BETWEEN {from} AND {to} AND {WEEK_OF_ENTRY_SQL} BETWEEN {first} AND {last}")
}

/// Four forecasts of cash, and whether the naive forecast filled in each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecasts {
    /// One per horizon: 7, 28, 84, 182 days.
    pub all: [Forecast; 4],
    /// Whether a naive forecast filled in the forecast, completely or in part.
    pub filled_naively: [bool; 4],
}

/// Describes how many forecasts were filled in naively: `by naive forecast`, `3 of 4 by naive forecast`, or `None`.
pub fn describe_naive_share(filled: &[bool]) -> Option<String> {
    match filled.iter().filter(|filled| **filled).count() {
        0 => None,
        all if all == filled.len() => Some("by naive forecast".to_owned()),
        some => Some(format!("{some} of {} by naive forecast", filled.len())),
    }
}

impl Forecasts {
    /// Reads the forecasts of a line; `None` unless there is one for each horizon.
    pub(crate) fn from_filed(filed: &[FiledForecast]) -> Option<Forecasts> {
        let filed: &[FiledForecast; 4] = filed.try_into().ok()?;
        Some(Forecasts {
            all: filed.map(|forecast| forecast.to_forecast()),
            filled_naively: filed.map(|forecast| forecast.filled_naively),
        })
    }

    /// Converts the forecasts to their form in a line.
    pub(crate) fn to_filed(self) -> Vec<FiledForecast> {
        let one = |(forecast, filled_naively): (Forecast, bool)| {
            let Forecast { horizon_days, point, lower, upper } = forecast;
            FiledForecast { horizon_days, point, lower, upper, filled_naively }
        };
        self.all.into_iter().zip(self.filled_naively).map(one).collect()
    }

    /// Converts the forecasts to the `predictions` of next_week.
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
    fn naive_share_is_described() {
        let texts =
            [[false; 4], [false, true, true, true], [true; 4]].map(|filled| describe_naive_share(&filled));
        assert_eq!(
            texts,
            [None, Some("3 of 4 by naive forecast".to_owned()), Some("by naive forecast".to_owned())]
        );
    }

    #[test]
    fn week_of_counts_from_1_and_returns_0_for_day_0() {
        for (day, week) in [(0, 0), (1, 1), (7, 1), (8, 2), (497, 71), (500, 72), (504, 72)] {
            assert_eq!(week_of(day), week, "day {day}");
        }
    }
}
