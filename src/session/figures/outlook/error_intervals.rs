//! Ranges of forecast errors by stage and horizon, measured with `novamind lab forecasts`, and their coverage.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::cash_path::CashPath;
use super::growth_stage::GrowthStage;
use novamind_base::statistics::quantile_of_sorted;

/// Minimum number of companies for which the coverage of a stage is shown.
const MIN_COMPANIES: usize = 50;
/// Minimum coverage of the 95 % ranges for which the coverage of a stage is shown.
const MIN_COVERAGE: f64 = 0.9;

/// Share of the outcomes that a range should contain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// 80 %: 10 % of the outcomes are below the range and 10 % above it.
    Central80,
    /// 95 %.
    Central95,
}

/// The error of a forecast for a company in a back-test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForecastError {
    /// Number of the company.
    pub company: usize,
    /// Stage of the company at the time of the forecast.
    pub stage: GrowthStage,
    /// Horizon of the forecast, in days.
    pub horizon: u32,
    /// Actual cash less expected cash, as a share of [`error_scale`](super::Outlook::error_scale). After a bankruptcy,
    /// the actual cash is 0.
    pub error: f64,
    /// Expected cash, as a share of the same amount.
    pub expected: f64,
}

/// Ranges of errors for a stage and a horizon, as shares of the error scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StageInterval {
    /// Stage of the companies.
    pub stage: GrowthStage,
    /// Horizon of the forecasts, in days.
    pub horizon: u32,
    /// Number of companies with forecasts in this stage.
    pub companies: usize,
    /// Number of forecasts.
    pub forecasts: usize,
    /// Lower end of the 95 % range, not positive.
    pub lower_95: f64,
    /// Lower end of the 80 % range, not positive.
    pub lower_80: f64,
    /// Upper end of the 80 % range, not negative.
    pub upper_80: f64,
    /// Upper end of the 95 % range, not negative.
    pub upper_95: f64,
    /// Share of the outcomes within 95 % ranges that were measured on other companies.
    pub covered_95: f64,
    /// Share of the outcomes within 80 % ranges that were measured on other companies.
    pub covered_80: f64,
}

/// Ranges and coverage from a back-test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorIntervals {
    /// Number of companies in the back-test.
    pub companies: usize,
    /// Ranges by stage and horizon, shortest horizon first.
    pub interval: Vec<StageInterval>,
}

static BUNDLED: LazyLock<ErrorIntervals> = LazyLock::new(|| {
    toml::from_str(include_str!("../../../../assets/outlook-intervals.toml"))
        .expect("the bundled intervals are valid")
});

/// Returns the amount to which forecast errors are proportional, in dollars. If the company has no income, the errors
/// come from decisions about the remaining cash. Otherwise, they come from its income and costs.
pub(super) fn error_scale(stage: GrowthStage, path: &CashPath, days: u32) -> f64 {
    let (cash, turnover) = (path.cash(0).max(0.0), path.turnover(days));
    let scale = match stage {
        GrowthStage::Start | GrowthStage::Idle => cash,
        GrowthStage::Launching | GrowthStage::Young => cash + turnover,
        GrowthStage::Surging | GrowthStage::Growing | GrowthStage::Steady | GrowthStage::Shrinking => {
            turnover
        }
    };
    scale.max(1.0)
}

impl ErrorIntervals {
    /// Returns the bundled intervals.
    pub fn bundled() -> &'static ErrorIntervals {
        &BUNDLED
    }

    /// Computes intervals from measured errors. The coverage of each half of the companies is measured with the
    /// intervals of the other half.
    pub fn from_errors(errors: &[ForecastError], companies: usize) -> ErrorIntervals {
        let mut horizons: Vec<u32> = errors.iter().map(|error| error.horizon).collect();
        horizons.sort_unstable();
        horizons.dedup();
        let cells = GrowthStage::ALL
            .into_iter()
            .flat_map(|stage| horizons.iter().map(move |horizon| (stage, *horizon)));
        let interval = cells.map(|(stage, horizon)| {
            let matching = errors.iter().filter(|error| (error.stage, error.horizon) == (stage, horizon));
            measure_interval(stage, horizon, &matching.copied().collect::<Vec<_>>())
        });
        ErrorIntervals { companies, interval: interval.collect() }
    }

    /// Returns the interval of a stage at a measured horizon.
    pub fn stage_interval(&self, stage: GrowthStage, horizon: u32) -> Option<&StageInterval> {
        self.interval.iter().find(|interval| (interval.stage, interval.horizon) == (stage, horizon))
    }

    /// Returns the distances from the expected cash to both endpoints of the range, for each day of a path. The
    /// distances grow linearly between measured horizons and never decrease.
    pub(super) fn widths(&self, stage: GrowthStage, level: Level, path: &CashPath) -> Vec<[f64; 2]> {
        let mut widths = vec![[0.0; 2]];
        for interval in self.interval.iter().filter(|interval| interval.stage == stage) {
            let scale = error_scale(stage, path, interval.horizon);
            let [from, shares] = [*widths.last().unwrap_or(&[0.0; 2]), interval.shares(level)];
            let until = [0, 1].map(|side: usize| from[side].max(shares[side].abs() * scale));
            let days = (interval.horizon as usize + 1).saturating_sub(widths.len());
            let step =
                |at: usize, side: usize| from[side] + (until[side] - from[side]) * at as f64 / days as f64;
            widths.extend((1..=days).map(|at| [step(at, 0), step(at, 1)]));
        }
        widths
    }

    /// Describes the measured coverage of the 95 % ranges for companies of a stage, up to a horizon. Returns `None` if
    /// too few companies were measured or the ranges contained too few outcomes.
    pub fn describe_coverage(&self, stage: GrowthStage, longest: u32) -> Option<String> {
        let shown =
            self.interval.iter().filter(|interval| interval.stage == stage && interval.horizon <= longest);
        let shown: Vec<&StageInterval> = shown.collect();
        let companies = shown.iter().map(|interval| interval.companies).min()?;
        let least = shown.iter().map(|interval| interval.covered_95).fold(1.0, f64::min);
        let most = shown.iter().map(|interval| interval.covered_95).fold(0.0, f64::max);
        if companies < MIN_COMPANIES || least < MIN_COVERAGE {
            return None;
        }
        let percent = |share: f64| (share * 100.0).round();
        let share = match percent(least) == percent(most) {
            true => format!("{} %", percent(least)),
            false => format!("{} to {} %", percent(least), percent(most)),
        };
        Some(format!(
            "In a back-test, such ranges contained the actual cash of {} in {share} of the cases",
            stage.describe()
        ))
    }
}

impl StageInterval {
    fn shares(&self, level: Level) -> [f64; 2] {
        match level {
            Level::Central80 => [self.lower_80, self.upper_80],
            Level::Central95 => [self.lower_95, self.upper_95],
        }
    }

    fn contains(&self, level: Level, error: &ForecastError) -> bool {
        let [lower, upper] = self.shares(level);
        // The lower end of a range is never below zero cash.
        let lower = lower.max(-error.expected);
        (lower - ROUNDING..=upper + ROUNDING).contains(&error.error)
    }
}

/// Precision of the shares in the file. Smaller errors count as 0.
const ROUNDING: f64 = 1e-4;

fn measure_interval(stage: GrowthStage, horizon: u32, errors: &[ForecastError]) -> StageInterval {
    let fit = |errors: &mut dyn Iterator<Item = &ForecastError>| {
        let mut values: Vec<f64> = errors.map(|error| error.error).collect();
        values.sort_unstable_by(f64::total_cmp);
        let end = |share: f64| (quantile_of_sorted(&values, share).unwrap_or(0.0) * 1e4).round() / 1e4;
        StageInterval {
            stage,
            horizon,
            companies: 0,
            forecasts: values.len(),
            lower_95: end(0.025).min(0.0),
            lower_80: end(0.1).min(0.0),
            upper_80: end(0.9).max(0.0),
            upper_95: end(0.975).max(0.0),
            covered_95: 0.0,
            covered_80: 0.0,
        }
    };
    let mut companies: Vec<usize> = errors.iter().map(|error| error.company).collect();
    companies.dedup();
    let covered = |level: Level| {
        let count = |half: usize| {
            let other = fit(&mut errors.iter().filter(|error| error.company % 2 != half));
            errors.iter().filter(|error| error.company % 2 == half && other.contains(level, error)).count()
        };
        ((count(0) + count(1)) as f64 / errors.len().max(1) as f64 * 1e4).round() / 1e4
    };
    StageInterval {
        companies: companies.len(),
        covered_95: covered(Level::Central95),
        covered_80: covered(Level::Central80),
        ..fit(&mut errors.iter())
    }
}
