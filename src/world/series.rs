//! Recorded series from the released simulator. The series do not depend on the company's actions. A scenario can
//! replay these series instead of drawing values (`docs/mechanics/randomness.md#recorded-series`).

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use super::identifiers::{Channel, Group};
use super::params::{Params, Replayed};

/// Series that were recorded in one run of the released simulator.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Series {
    pmi: Vec<f64>,
    competitor_events: Vec<(u32, f64, f64)>,
    demand_surges: Vec<(u32, u32, f64)>,
    market_research: Vec<String>,
    involuntary_churn: BTreeMap<Group, Vec<f64>>,
    channel_yields: BTreeMap<Channel, BTreeMap<Group, Vec<f64>>>,
}

/// A recorded competitor event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedEvent {
    /// Gain in quality before the growth over the run.
    pub size: f64,
    /// Share of the player's shared quality bank that competitors could copy.
    pub u: f64,
}

/// A recorded demand surge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedSurge {
    /// Duration in days.
    pub days: u32,
    /// Factor by which the surge multiplies leads.
    pub multiplier: f64,
}

static SEED_42: LazyLock<Series> = LazyLock::new(|| {
    let text = include_str!("../../configs/series/seed42.toml");
    toml::from_str(text).expect("the bundled series is valid")
});

impl Params {
    /// Returns the recorded series that a world with these parameters replays, if any.
    pub fn replayed_series(&self) -> Option<&'static Series> {
        match self.series.replayed {
            Replayed::None => None,
            Replayed::Seed42 => Some(&SEED_42),
        }
    }
}

/// Each method returns `None` after the end of the recorded series. The world then draws as usual.
impl Series {
    /// Returns the hidden PMI on a day.
    pub fn pmi(&self, day: u32) -> Option<f64> {
        self.pmi.get(day.checked_sub(1)? as usize).copied()
    }

    /// Returns the competitor event of a day, or `Some(None)` for a day without an event.
    pub fn competitor_event(&self, day: u32) -> Option<Option<RecordedEvent>> {
        let found = self.competitor_events.iter().find(|(number, _, _)| *number == day);
        self.pmi(day).map(|_| found.map(|&(_, size, u)| RecordedEvent { size, u }))
    }

    /// Returns the demand surge that was drawn for a day, or `Some(None)` for a day without a surge.
    pub fn demand_surge(&self, day: u32) -> Option<Option<RecordedSurge>> {
        let found = self.demand_surges.iter().find(|(number, _, _)| *number == day);
        self.pmi(day).map(|_| found.map(|&(_, days, multiplier)| RecordedSurge { days, multiplier }))
    }

    /// Returns the group that an attempt of market research discovered, or `Some(None)` if the attempt failed.
    /// `earlier` is the number of earlier attempts.
    pub fn attempt(&self, earlier: u32) -> Option<Option<Group>> {
        self.market_research.get(earlier as usize).map(|id| Group::parse(id))
    }

    /// Returns the rate of failed payments in a group in a month. Months are counted from 0.
    pub fn involuntary_rate(&self, group: Group, month: u32) -> Option<f64> {
        self.involuntary_churn.get(&group)?.get(month as usize).copied()
    }

    /// Returns the channel yield in a month, in leads per 1,000 dollars. Months are counted from 1.
    pub fn channel_yield(&self, channel: Channel, group: Group, month: u32) -> Option<f64> {
        self.channel_yields.get(&channel)?.get(&group)?.get(month.checked_sub(1)? as usize).copied()
    }
}
