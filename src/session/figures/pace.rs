//! How money goes on: what the settings commit to, what recent weeks brought and took besides, how long cash lasts at
//! that, and the naive projection that follows from it.

use serde::Serialize;

use super::scored_forecast::{ForecastScore, ScoredForecast, filed_forecasts};
use super::week::{Forecasts, WeekFigures};
use crate::session::state::Session;
use crate::tools::Forecast;
use crate::world::events::Category;

/// Weeks that are recent.
const RECENT: usize = 4;
/// Forecasts of a horizon whose errors are remembered.
const REMEMBERED: usize = 8;
/// Standard deviations of a 95 % interval.
const DEVIATIONS: f64 = 1.96;
/// Error of the pace while no forecast has come due: a quarter of what it moves.
const UNTRIED_ERROR: f64 = 0.25;
/// Least half width of an interval, as a share of cash after a week.
const LEAST_WIDTH: f64 = 0.005;

/// Dollars a day.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Pace {
    /// Costs that the settings commit to: capacity, operations, development, advertising.
    pub committed: f64,
    /// Payments and ad revenue, mean of the last four weeks.
    pub income: f64,
    /// Compute and lead costs, mean of the last four weeks.
    pub variable: f64,
    /// Standard deviation of income less variable costs from day to day.
    pub spread: f64,
}

impl Pace {
    /// The pace of a company with these daily commitments and these recent weeks.
    pub fn of(committed: f64, weeks: &[WeekFigures]) -> Pace {
        let recent = &weeks[weeks.len().saturating_sub(RECENT)..];
        let days: u32 = recent.iter().map(|week| week.days_run).sum();
        if days == 0 {
            return Pace { committed, ..Pace::default() };
        }
        let (income, variable): (Vec<f64>, Vec<f64>) = recent.iter().map(flows).unzip();
        let daily: Vec<f64> = recent
            .iter()
            .zip(income.iter().zip(&variable))
            .map(|(week, (income, variable))| (income - variable) / f64::from(week.days_run.max(1)))
            .collect();
        Pace {
            committed,
            income: income.iter().sum::<f64>() / f64::from(days),
            variable: variable.iter().sum::<f64>() / f64::from(days),
            // A week's mean spreads less than its days.
            spread: deviation(&daily) * 7f64.sqrt(),
        }
    }

    /// What a day changes cash by.
    pub fn net(&self) -> f64 {
        self.income - self.committed - self.variable
    }

    /// Weeks until cash is gone; none while it does not shrink.
    pub fn runway_weeks(&self, cash: f64) -> Option<f64> {
        (self.net() < 0.0).then(|| cash.max(0.0) / -self.net() / 7.0)
    }

    /// The naive projection: the pace goes on. The interval holds the spread from day to day and the errors of the
    /// forecasts that have come due.
    pub fn project(&self, cash: f64, horizons: &[u32], filed: &[ScoredForecast]) -> Forecasts {
        let one = |horizon_days: u32| {
            let days = f64::from(horizon_days);
            let untried = UNTRIED_ERROR * self.net().abs() * days;
            let error = past_error(filed, horizon_days).unwrap_or(untried);
            let wandering = self.spread * days.sqrt();
            let least = LEAST_WIDTH * cash.abs().max(1.0) * (days / 7.0).sqrt();
            let half = (DEVIATIONS * wandering.hypot(error)).max(least).max(0.01);
            let point = cash + self.net() * days;
            Forecast {
                horizon_days,
                point: cents(point),
                lower: cents(point - half),
                upper: cents(point + half),
            }
        };
        Forecasts { all: std::array::from_fn(|at| one(horizons[at])), filled_naively: [true; 4] }
    }
}

/// Income and variable costs of a week, both positive.
fn flows(week: &WeekFigures) -> (f64, f64) {
    let of = |category| week.booked.of(category);
    (
        of(Category::SubscriptionPayment) + of(Category::AdRevenue),
        -(of(Category::Compute) + of(Category::LeadAcquisitionCost)),
    )
}

/// Sample standard deviation; 0 below two values.
fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count.max(1.0);
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    if values.len() < 2 { 0.0 } else { (squares / (count - 1.0)).sqrt() }
}

/// How far off the last forecasts of a horizon were, root mean square; before the first, those of the next shorter
/// horizon, in proportion.
fn past_error(filed: &[ScoredForecast], horizon_days: u32) -> Option<f64> {
    let ahead = |filed: &ScoredForecast| filed.forecast.horizon_days;
    let tried = filed.iter().filter(|filed| filed.outcome.is_some() && ahead(filed) <= horizon_days);
    let nearest = tried.map(ahead).max()?;
    let squares: Vec<f64> = filed
        .iter()
        .rev()
        .filter(|filed| ahead(filed) == nearest)
        .filter_map(|filed| filed.outcome.map(|outcome| filed.forecast.point - outcome))
        .map(|miss| miss * miss)
        .take(REMEMBERED)
        .collect();
    let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    Some(error * f64::from(horizon_days) / f64::from(nearest))
}

fn cents(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

impl Session {
    /// Scores of the forecasts so far, one per horizon.
    pub fn forecast_scores(&self) -> Vec<ForecastScore> {
        let filed = filed_forecasts(&self.history.journal, &self.history.cash_by_day);
        let horizons = self.simulation.params.limits.prediction_horizons_days.iter();
        horizons.map(|horizon| ForecastScore::of(*horizon, &filed)).collect()
    }

    /// How money goes on from here.
    pub fn pace(&self) -> Pace {
        let running = (self.history.running_week.days_run > 0).then_some(self.history.running_week);
        let weeks: Vec<WeekFigures> = self.history.weeks.iter().copied().chain(running).collect();
        Pace::of(self.daily_cost(&self.simulation.world.settings), &weeks)
    }

    /// The naive projection of cash.
    pub fn naive_forecasts(&self) -> Forecasts {
        let filed = filed_forecasts(&self.history.journal, &self.history.cash_by_day);
        let horizons = &self.simulation.params.limits.prediction_horizons_days;
        self.pace().project(self.simulation.world.finance.cash, horizons, &filed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::figures::booked::Booked;

    const HORIZONS: [u32; 4] = [7, 28, 84, 182];

    fn week(income: f64, compute: f64) -> WeekFigures {
        let mut booked = Booked::default();
        booked.add(Category::SubscriptionPayment, income);
        booked.add(Category::Compute, -compute);
        booked.add(Category::ResearchProject, -500_000.0);
        WeekFigures { days_run: 7, booked, ..WeekFigures::default() }
    }

    #[test]
    fn commitments_count_before_the_first_week() {
        let pace = Pace::of(5_585.0, &[]);
        let naive = pace.project(1_000_000.0, &HORIZONS, &[]);
        let points = naive.all.map(|forecast| forecast.point);
        assert_eq!(points, [960_905.0, 843_620.0, 530_860.0, -16_470.0]);
        assert!((pace.runway_weeks(1_000_000.0).expect("cash shrinks") - 25.578_72).abs() < 1e-4);
        assert!(naive.all.iter().all(|one| one.lower < one.point && one.point < one.upper));
    }

    #[test]
    fn an_idle_company_without_costs_has_an_interval_too() {
        let naive = Pace::default().project(1_000_000.0, &HORIZONS, &[]);
        assert_eq!(Pace::default().runway_weeks(1.0), None);
        for one in naive.all {
            assert!(one.lower < one.point && one.point < one.upper && one.point == 1_000_000.0, "{one:?}");
        }
        let broke = Pace::default().project(0.0, &HORIZONS, &[]);
        assert!(broke.all[0].lower < 0.0 && broke.all[0].upper > 0.0);
    }

    #[test]
    fn purchases_are_no_pace_and_only_four_weeks_are_recent() {
        let weeks =
            [week(1e9, 0.0), week(700.0, 70.0), week(1400.0, 70.0), week(700.0, 70.0), week(1400.0, 70.0)];
        let pace = Pace::of(100.0, &weeks);
        assert_eq!((pace.income, pace.variable, pace.net()), (150.0, 10.0, 40.0));
        // Weeks of 90 and 190 dollars a day.
        let deviation = (4.0 * 2500.0f64 / 3.0).sqrt() * 7f64.sqrt();
        assert!((pace.spread - deviation).abs() < 1e-9);
    }

    #[test]
    fn the_spread_of_days_grows_with_the_root_of_time() {
        let pace = Pace { committed: 0.0, income: 50.0, variable: 50.0, spread: 2_000.0 };
        for one in pace.project(1_000.0, &HORIZONS, &[]).all {
            let half = 1.96 * 2_000.0 * f64::from(one.horizon_days).sqrt();
            assert!((one.upper - 1_000.0 - half).abs() < 0.01 && (1_000.0 - one.lower - half).abs() < 0.01);
        }
    }

    #[test]
    fn past_errors_widen_the_interval_of_their_horizon_and_of_longer_ones() {
        let missed = |horizon_days: u32, by: f64| ScoredForecast {
            day: 0,
            forecast: Forecast { horizon_days, point: 100.0 + by, lower: 0.0, upper: 1.0 },
            outcome: Some(100.0),
        };
        let pace = Pace::of(10.0, &[]);
        let half = |filed: &[ScoredForecast], at: usize| {
            let one = pace.project(1000.0, &HORIZONS, filed).all[at];
            (one.upper - one.lower) / 2.0
        };
        let filed = [missed(7, 300.0), missed(7, -400.0), missed(28, 5000.0)];
        let weekly = (300.0f64 * 300.0 + 400.0 * 400.0).sqrt() / 2f64.sqrt();
        assert!((half(&filed, 0) - 1.96 * weekly).abs() < 0.01);
        assert!((half(&filed, 1) - 1.96 * 5000.0).abs() < 0.01);
        assert!((half(&filed, 2) - 1.96 * 15_000.0).abs() < 0.01, "in proportion to the horizon");
        assert!(half(&[], 0) < half(&filed, 0));
    }
}
