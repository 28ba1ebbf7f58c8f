//! Recorded series: what happened in the released simulator and does not depend on what a company does. A scenario
//! replays it in place of draws (`docs/mechanics/randomness.md#recorded-series`).

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use super::identifiers::{Channel, Group};
use super::params::{Params, Replayed};

/// One recorded run of the market.
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
pub struct GivenEvent {
    /// Size before the growth over the run.
    pub size: f64,
    /// Share of the shared bank that rivals could copy.
    pub u: f64,
}

/// A recorded demand surge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenSurge {
    /// Its length in days.
    pub days: u32,
    /// Factor on leads.
    pub multiplier: f64,
}

static SEED_42: LazyLock<Series> = LazyLock::new(|| {
    let text = include_str!("../../configs/series/seed42.toml");
    toml::from_str(text).expect("the shipped series is tested")
});

impl Params {
    /// The recorded series that this world replays, if it does.
    pub fn replayed_series(&self) -> Option<&'static Series> {
        match self.series.replayed {
            Replayed::None => None,
            Replayed::Seed42 => Some(&SEED_42),
        }
    }
}

/// Each reading is none beyond the end of the record: then the world draws as usual.
impl Series {
    /// Hidden index of the economy on a day.
    pub fn pmi(&self, day: u32) -> Option<f64> {
        self.pmi.get(day.checked_sub(1)? as usize).copied()
    }

    /// The competitor event of a day, if there was one.
    pub fn competitor_event(&self, day: u32) -> Option<Option<GivenEvent>> {
        let found = self.competitor_events.iter().find(|(own, _, _)| *own == day);
        self.pmi(day).map(|_| found.map(|&(_, size, u)| GivenEvent { size, u }))
    }

    /// The demand surge that was drawn for a day, if there was one.
    pub fn demand_surge(&self, day: u32) -> Option<Option<GivenSurge>> {
        let found = self.demand_surges.iter().find(|(own, _, _)| *own == day);
        self.pmi(day).map(|_| found.map(|&(_, days, multiplier)| GivenSurge { days, multiplier }))
    }

    /// The group that an attempt of market research found, if any; attempts count from 0.
    pub fn attempt(&self, earlier: u32) -> Option<Option<Group>> {
        self.market_research.get(earlier as usize).map(|id| Group::parse(id))
    }

    /// Rate of failed payments of a group in a month, which counts from 0.
    pub fn involuntary_rate(&self, group: Group, month: u32) -> Option<f64> {
        self.involuntary_churn.get(&group)?.get(month as usize).copied()
    }

    /// Leads a day for 1,000 dollars a day from a month on, which counts from 1.
    pub fn channel_yield(&self, channel: Channel, group: Group, month: u32) -> Option<f64> {
        self.channel_yields.get(&channel)?.get(&group)?.get(month.checked_sub(1)? as usize).copied()
    }
}
