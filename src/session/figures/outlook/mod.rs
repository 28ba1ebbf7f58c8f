//! The outlook of a company: expected cash by day with its ranges. The runway, the expected income and costs, and naive
//! forecasts are read from one outlook, so they agree. The outlook uses only figures that the player can see.

mod billing_calendar;
mod cash_path;
mod error_intervals;
mod growth_stage;

use novamind_record::figures::WeekFigures;
use novamind_tools::Forecast;
use novamind_world::events::Category;

pub use billing_calendar::BillingCalendar;
pub use error_intervals::{ErrorIntervals, ForecastError, Level, StageInterval};
pub use growth_stage::GrowthStage;

use self::cash_path::{CashPath, daily_amount};
use super::week::Forecasts;

/// Last day of the runway, counted from today. Ranges were not measured for longer horizons.
pub const MAX_RUNWAY_DAYS: u32 = 182;

/// Expected cash of a company by day, with ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlook {
    /// Stage of the company, which determines the width of the ranges.
    pub stage: GrowthStage,
    /// Change of the advertising budget since the last week, if it is large. The outlook does not include the signups
    /// that result from the change.
    pub advertising_change: Option<AdvertisingChange>,
    path: CashPath,
    /// Distances from the expected cash to the endpoints of each range by day, dollars.
    widths: [Vec<[f64; 2]>; 2],
}

/// Costs to which the current settings commit the company, dollars per day.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CommittedCosts {
    /// Capacity, operations, development and advertising.
    pub total: f64,
    /// Advertising alone.
    pub advertising: f64,
}

/// A large change of the advertising budget since the last week.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdvertisingChange {
    /// Spending of the last week, dollars per day.
    pub before: f64,
    /// Current budget, dollars per day.
    pub now: f64,
}

impl AdvertisingChange {
    /// Ratio of the larger to the smaller budget from which a change is large.
    const MIN_RATIO: f64 = 1.25;

    fn since(weeks: &[WeekFigures], now: f64) -> Option<AdvertisingChange> {
        let before = daily_amount(&[*weeks.last()?], Category::Advertising);
        let is_large = now.max(before) > AdvertisingChange::MIN_RATIO * now.min(before);
        is_large.then_some(AdvertisingChange { before, now })
    }

    /// Returns the additional spending in dollars per day; negative after a reduction.
    pub fn added(self) -> f64 {
        self.now - self.before
    }
}

/// Expected flows of the next weeks, dollars per week.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExpectedFlows {
    /// Payments and ad revenue.
    pub income: f64,
    /// Compute and lead costs.
    pub variable: f64,
}

/// Weeks for which cash lasts. `None` if cash lasts as long as the run, or for at least 26 weeks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Runway {
    /// Weeks until the low end of the 80 % range is below zero.
    pub earliest: Option<f64>,
    /// Weeks until the expected cash is below zero.
    pub expected: Option<f64>,
    /// Weeks until the high end of the 80 % range is below zero.
    pub latest: Option<f64>,
    /// Whether the run continues for more than 26 weeks.
    pub is_cut: bool,
}

impl Outlook {
    /// Computes the outlook of a company with these complete weeks.
    pub fn new(
        cash: f64,
        costs: CommittedCosts,
        calendar: &BillingCalendar,
        weeks: &[WeekFigures],
        horizons: &[u32],
    ) -> Outlook {
        let days = horizons.iter().copied().max().unwrap_or(0).max(MAX_RUNWAY_DAYS);
        let stage = GrowthStage::from_weeks(weeks, costs.advertising > 0.0);
        let path = CashPath::new(cash, costs.total, calendar, weeks, days);
        let widths = [Level::Central80, Level::Central95]
            .map(|level| ErrorIntervals::bundled().widths(stage, level, &path));
        let advertising_change = AdvertisingChange::since(weeks, costs.advertising);
        Outlook { stage, advertising_change, path, widths }
    }

    /// Returns the expected cash after a number of days. Cash below zero ends a run, so the value is not negative.
    pub fn expected_cash(&self, days: u32) -> f64 {
        self.path.cash(days).max(0.0)
    }

    /// Returns the range of cash after a number of days.
    pub fn range(&self, days: u32, level: Level) -> (f64, f64) {
        let [below, above] = self.width(days, level);
        let expected = self.expected_cash(days);
        ((expected - below).max(0.0), expected + above)
    }

    /// Returns the amount to which errors of a forecast are proportional, in dollars.
    pub fn error_scale(&self, days: u32) -> f64 {
        error_intervals::error_scale(self.stage, &self.path, days)
    }

    /// Returns the mean flows per week that are expected for a number of days.
    pub fn expected_flows(&self, days: u32) -> ExpectedFlows {
        let weeks = f64::from(days.max(1)) / 7.0;
        let (income, variable) = self.path.flows(days);
        ExpectedFlows { income: income / weeks, variable: variable / weeks }
    }

    /// Returns the weeks for which cash lasts in a run with this number of remaining days.
    pub fn runway(&self, days_left: u32) -> Runway {
        let last = days_left.min(MAX_RUNWAY_DAYS);
        let until =
            |shift: &dyn Fn(u32) -> f64| weeks_above_zero(last, |day| self.path.cash(day) + shift(day));
        Runway {
            earliest: until(&|day| -self.width(day, Level::Central80)[0]),
            expected: until(&|_| 0.0),
            latest: until(&|day| self.width(day, Level::Central80)[1]),
            is_cut: days_left > MAX_RUNWAY_DAYS,
        }
    }

    /// Returns the weeks for which the expected cash lasts if costs are lower by `saving` dollars per day.
    pub fn runway_with_saving(&self, saving: f64, days_left: u32) -> Option<f64> {
        let last = days_left.min(MAX_RUNWAY_DAYS);
        weeks_above_zero(last, |day| self.path.cash(day) + saving * f64::from(day))
    }

    /// Returns the smallest saving in dollars per day with which the expected cash lasts for a number of days.
    pub fn required_saving(&self, days: u32) -> f64 {
        (1..=days).map(|day| -self.path.cash(day) / f64::from(day)).fold(0.0, f64::max)
    }

    /// Returns the naive forecast of cash after a number of days.
    pub fn forecast(&self, horizon_days: u32) -> Forecast {
        let (lower, upper) = self.range(horizon_days, Level::Central95);
        let point = self.expected_cash(horizon_days);
        let [lower, point, upper] = [lower, point, upper].map(round_to_cents);
        Forecast { horizon_days, point, lower, upper }
    }

    /// Returns the naive forecasts of cash for four horizons.
    pub(crate) fn naive_forecasts(&self, horizons: &[u32]) -> Forecasts {
        Forecasts { all: std::array::from_fn(|at| self.forecast(horizons[at])), filled_naively: [true; 4] }
    }

    fn width(&self, days: u32, level: Level) -> [f64; 2] {
        let widths = &self.widths[level as usize];
        widths.get(days as usize).or(widths.last()).copied().unwrap_or_default()
    }
}

impl Runway {
    /// Returns the range of whole weeks for which cash lasts, for example `9–19`, `9+` or `26+`. Returns `None` if cash
    /// lasts to the end of the run.
    pub fn describe_weeks(&self) -> Option<String> {
        match (self.earliest.map(f64::floor), self.latest.map(f64::floor)) {
            (None, _) if self.is_cut => Some(format!("{}+", MAX_RUNWAY_DAYS / 7)),
            (None, _) => None,
            (Some(least), None) => Some(format!("{least}+")),
            (Some(least), Some(most)) if least == most => Some(format!("{least}")),
            (Some(least), Some(most)) => Some(format!("{least}–{most}")),
        }
    }
}

/// Returns the number of weeks after which cash is below zero, or `None` if cash is not negative on any day until
/// `last`.
fn weeks_above_zero(last: u32, cash: impl Fn(u32) -> f64) -> Option<f64> {
    let day = (1..=last).find(|day| cash(*day) < 0.0)?;
    let (before, after) = (cash(day - 1).max(0.0), cash(day));
    Some((f64::from(day - 1) + before / (before - after)) / 7.0)
}

fn round_to_cents(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests;
