//! Forecasts that were filed, and what came of them.

use super::JournalEntry;
use crate::tools::Forecast;

/// A forecast of cash, and what came if its day has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filed {
    /// Day on which it was filed.
    pub day: u32,
    /// Days ahead.
    pub horizon_days: u32,
    /// What was said, dollars.
    pub point: f64,
    /// Lower end of the interval, dollars.
    pub lower: f64,
    /// Upper end of the interval, dollars.
    pub upper: f64,
    /// What came, dollars; none before its day.
    pub outcome: Option<f64>,
}

impl Filed {
    /// A forecast that was filed on a day. `cash_by_day` is cash at the end of each day, day 0 first.
    pub fn of(day: u32, forecast: &Forecast, cash_by_day: &[f64]) -> Filed {
        Filed {
            day,
            horizon_days: forecast.horizon_days,
            point: forecast.point,
            lower: forecast.lower,
            upper: forecast.upper,
            outcome: cash_by_day.get((day + forecast.horizon_days) as usize).copied(),
        }
    }

    /// The day it speaks of.
    pub fn due(&self) -> u32 {
        self.day + self.horizon_days
    }

    /// -1 below the interval, 0 inside, 1 above; none before its day.
    pub fn verdict(&self) -> Option<i32> {
        let outcome = self.outcome?;
        Some(i32::from(outcome > self.upper) - i32::from(outcome < self.lower))
    }

    /// Whether the interval held what came.
    pub fn is_inside(&self) -> bool {
        self.outcome.is_some_and(|outcome| self.lower <= outcome && outcome <= self.upper)
    }

    /// How far the point was off, as a share of what came; above it positive.
    pub fn error(&self) -> Option<f64> {
        let outcome = self.outcome.filter(|outcome| *outcome != 0.0)?;
        Some((self.point - outcome) / outcome.abs())
    }
}

/// Every forecast that was filed, in the order of filing. `cash_by_day` is cash at the end of each day, day 0 first.
pub fn filed_forecasts(journal: &[JournalEntry], cash_by_day: &[f64]) -> Vec<Filed> {
    let mut all = Vec::new();
    for entry in journal {
        let JournalEntry::Advance { day, forecasts, .. } = entry else { continue };
        all.extend(forecasts.iter().map(|forecast| Filed::of(*day, forecast, cash_by_day)));
    }
    all
}
