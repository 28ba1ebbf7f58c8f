//! The figures of a week, and what a player must file before it runs (chapter 60 §8.1, chapter 70 §5).

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::notation::json_number;
use crate::tools::{FORECAST_KEYS, Forecast};
use crate::world::events::DayFigures;

/// Figures of a week, or of the part of it that ran.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct WeekFigures {
    /// Last day.
    pub day: u32,
    /// Days that ran.
    pub days_run: u32,
    /// Cash at the end, dollars.
    pub cash: f64,
    /// Its change over the days that ran, dollars.
    pub cash_change: f64,
    /// Active subscriptions of individuals.
    pub individual_subscribers: u32,
    /// Seats of active companies.
    pub enterprise_seats: u32,
    /// Active subscribers with an open issue.
    pub open_issues: u32,
    /// Units used.
    pub usage: u64,
    /// Leads of individuals.
    pub new_individual_leads: u32,
    /// Leads of companies that opened a thread.
    pub new_enterprise_leads: u32,
    /// Individuals who signed up.
    pub new_individual_subscribers: u32,
    /// Seats of companies that signed.
    pub new_enterprise_seats: u32,
    /// Cancellations of individuals.
    pub cancellations: u32,
    /// Switches to dearer plans.
    pub upgrades: u32,
    /// Switches to cheaper plans.
    pub downgrades: u32,
    /// Companies that left.
    pub companies_lost: u32,
    /// Their seats.
    pub seats_lost: u32,
    /// Largest overload.
    pub overload_peak: f64,
    /// Minutes of outages.
    pub downtime_minutes: u32,
    /// Whether there was an outage.
    pub outage: bool,
    /// Highest latency, milliseconds.
    pub p95_ms_peak: f64,
    /// Highest error rate.
    pub error_rate_peak: f64,
    /// Payments of subscribers, dollars.
    pub payments: f64,
    /// Running costs, dollars.
    pub costs: f64,
    /// Monthly recurring revenue at the end, dollars.
    pub recurring_revenue: f64,
    /// Threads that were opened, and the seats behind them.
    pub threads_opened: u32,
    /// Seats of the companies that opened threads.
    pub thread_seats: u32,
    /// Messages of companies in their threads.
    #[serde(default)]
    pub replies: u32,
    /// R&D projects and studies of groups that were finished.
    #[serde(default)]
    pub research_finished: u32,
}

impl WeekFigures {
    /// Adds a day. Sums add up, peaks rise, stocks are those of the last day.
    pub fn add(&mut self, day: &DayFigures) {
        self.day = day.day;
        self.days_run += 1;
        self.cash = day.cash;
        self.individual_subscribers = day.individual_subscribers;
        self.enterprise_seats = day.enterprise_seats;
        self.recurring_revenue = day.mrr;
        self.usage += day.total_usage;
        self.new_individual_leads += day.new_individual_leads;
        self.new_enterprise_leads += day.new_enterprise_leads;
        self.new_individual_subscribers += day.new_individual_subscribers;
        self.new_enterprise_seats += day.new_enterprise_seats;
        self.cancellations += day.cancellations;
        self.upgrades += day.upgrades;
        self.downgrades += day.downgrades;
        self.payments += day.payments_received;
        self.costs += day.total_costs;
        self.downtime_minutes += day.downtime_minutes;
        self.outage |= day.outage;
        self.overload_peak = self.overload_peak.max(day.overload);
        self.p95_ms_peak = self.p95_ms_peak.max(day.p95_ms);
        self.error_rate_peak = self.error_rate_peak.max(day.error_rate);
    }

    /// The figures that a `week` line and programs carry, by their names of chapter 70 §5.
    pub fn as_json(&self) -> Map<String, Value> {
        let figures = json!({
            "cash": json_number(self.cash),
            "individual_subscribers": self.individual_subscribers,
            "enterprise_seats": self.enterprise_seats,
            "open_issues": self.open_issues,
            "usage": self.usage,
            "new_individual_leads": self.new_individual_leads,
            "new_enterprise_leads": self.new_enterprise_leads,
            "new_individual_subscribers": self.new_individual_subscribers,
            "new_enterprise_seats": self.new_enterprise_seats,
            "cancellations": self.cancellations,
            "upgrades": self.upgrades,
            "downgrades": self.downgrades,
            "overload_peak": json_number(self.overload_peak),
            "downtime_minutes": self.downtime_minutes,
            "p95_ms_peak": json_number(self.p95_ms_peak),
            "error_rate_peak": json_number(self.error_rate_peak),
            "payments": json_number(self.payments),
            "costs": json_number(self.costs),
            "recurring_revenue": json_number(self.recurring_revenue),
        });
        match figures {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }
}

/// Number of the week that holds a day: 0 -> 0, 1 to 7 -> 1, 8 -> 2.
pub fn week_of(day: u32) -> u32 {
    day.div_ceil(7)
}

/// Four forecasts of cash, and whether they were filled in by the naive projection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecasts {
    /// One per horizon: 7, 28, 84, 182 days.
    pub all: [Forecast; 4],
    /// Filled by the naive projection.
    pub filled_naively: bool,
}

impl Forecasts {
    /// The naive projection from the daily cash so far, day 0 first (chapter 70 §5): the mean daily change goes
    /// on, with the interval of a random walk.
    pub fn naive(cash_by_day: &[f64], horizons: &[u32]) -> Forecasts {
        let window = cash_by_day.len().saturating_sub(1).min(28);
        let recent = &cash_by_day[cash_by_day.len() - window - 1..];
        let changes: Vec<f64> = recent.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let count = changes.len() as f64;
        let mean = if changes.is_empty() { 0.0 } else { changes.iter().sum::<f64>() / count };
        let spread = if changes.len() < 2 {
            0.0
        } else {
            (changes.iter().map(|change| (change - mean) * (change - mean)).sum::<f64>() / (count - 1.0))
                .sqrt()
        };
        let cash = cash_by_day.last().copied().unwrap_or(0.0);
        let cents = |value: f64| (value * 100.0).round() / 100.0;
        let project = |horizon_days: u32| {
            let horizon = f64::from(horizon_days);
            let (point, half) = (cash + mean * horizon, 1.96 * spread * horizon.sqrt());
            Forecast {
                horizon_days,
                point: cents(point),
                lower: cents(point - half),
                upper: cents(point + half),
            }
        };
        Forecasts { all: std::array::from_fn(|at| project(horizons[at])), filled_naively: true }
    }

    /// The forecasts as the body of next_week carries them.
    pub fn as_predictions(&self) -> Value {
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

    const HORIZONS: [u32; 4] = [7, 28, 84, 182];

    #[test]
    fn check_2_of_chapter_60() {
        for (day, week) in [(0, 0), (1, 1), (7, 1), (8, 2), (497, 71), (500, 72), (504, 72)] {
            assert_eq!(week_of(day), week, "day {day}");
        }
    }

    #[test]
    fn the_naive_projection_goes_on_as_before() {
        let first = Forecasts::naive(&[1_000_000.0], &HORIZONS);
        assert!(first.all.iter().all(|f| f.point == 1_000_000.0 && f.lower == f.point && f.upper == f.point));
        let second = Forecasts::naive(&[1000.0, 915.0], &HORIZONS);
        assert_eq!((second.all[0].point, second.all[0].lower), (320.0, 320.0));
        let steady: Vec<f64> = (0..60).map(|day| 1000.0 - 85.0 * f64::from(day)).collect();
        assert_eq!(Forecasts::naive(&steady, &HORIZONS).all[3].point, 1000.0 - 85.0 * 241.0);
        let zigzag = [0.0, 10.0, 0.0, 10.0, 0.0];
        let wide = Forecasts::naive(&zigzag, &HORIZONS);
        let half = 1.96 * (400.0f64 / 3.0).sqrt() * 7.0f64.sqrt();
        assert!((wide.all[0].upper - half).abs() < 0.01 && wide.all[0].point == 0.0);
        assert_eq!(wide.as_predictions()["cash_1wk"]["point"], 0);
    }

    #[test]
    fn check_20_of_chapter_20_sums_and_peaks() {
        let mut week = WeekFigures::default();
        for day in 1..=7u32 {
            let outage = day == 3;
            week.add(&DayFigures {
                day,
                total_usage: u64::from(day) * 10,
                outage,
                downtime_minutes: if outage { 30 } else { 0 },
                overload: if day == 5 { 0.4 } else { 0.1 },
                ..DayFigures::default()
            });
        }
        assert_eq!(
            (week.usage, week.outage, week.downtime_minutes, week.overload_peak),
            (280, true, 30, 0.4)
        );
        assert_eq!((week.day, week.days_run), (7, 7));
    }
}
