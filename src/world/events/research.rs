//! What was found out and developed: R&D projects, studies of groups, attempts to find one.

use crate::canonical::canonical;
use crate::identifiers::Group;

/// One R&D project.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Project {
    /// Tier, 1..=20.
    pub tier: u8,
    /// Number of the start of this tier, from 1.
    pub number: u32,
    /// Day of the start.
    pub started_day: u32,
    /// First day on which it is finished.
    pub due_day: u32,
    /// Quality it adds.
    pub boost: f64,
    /// Day on which it was finished.
    pub completed_day: Option<u32>,
}

canonical! {
    Project { tier, number, started_day, due_day, boost, completed_day }
}

impl Project {
    /// Identifier as the tables write it, for instance t3_1.
    pub fn id(&self) -> String {
        format!("t{}_{}", self.tier, self.number)
    }
}

/// A study that runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Study {
    /// Group.
    pub group: Group,
    /// Level it aims at, 2..=5.
    pub target: u8,
    /// Level of the group when it was ordered.
    pub before: u8,
    /// First day on which it is finished.
    pub due_day: u32,
}

canonical! { Study { group, target, before, due_day } }

impl Study {
    /// Whether it brings the figures of the day and no better accuracy.
    pub fn is_refresh(&self) -> bool {
        self.target == self.before
    }
}

/// One attempt to find a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attempt {
    /// Attempts before this one, failed ones included.
    pub earlier: u32,
    /// Dollars paid.
    pub cost: f64,
    /// The group that was found.
    pub found: Option<Group>,
}

canonical! { Attempt { earlier, cost, found } }

/// What the company knows about a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knowledge {
    /// Info level, 0 while undiscovered.
    pub level: u8,
    /// Day of discovery.
    pub discovered_day: Option<u32>,
    /// Last day on which the level rose.
    pub last_research_day: Option<u32>,
    /// What estimates are made from, once the group is known.
    pub snapshot: Option<Snapshot>,
}

canonical! { Knowledge { level, discovered_day, last_research_day, snapshot } }

/// The moving values of a group as they were on a day; hidden, estimates are made from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Snapshot {
    /// Day.
    pub day: u32,
    /// Mean budget, dollars a month.
    pub c_max: f64,
    /// Mean quality floor.
    pub q_min: f64,
    /// Customers or accounts the market holds.
    pub market_cap: f64,
}

canonical! { Snapshot { day, c_max, q_min, market_cap } }
