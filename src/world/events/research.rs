//! Facts about research: R&D projects, studies of groups, attempts to discover one.

use crate::canonical::canonical;
use crate::identifiers::Group;

/// One R&D project.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Project {
    /// Tier, 1..=20.
    pub tier: u8,
    /// Number of the project within its tier, from 1.
    pub number: u32,
    /// Day of the start.
    pub started_day: u32,
    /// First day on which it is complete.
    pub due_day: u32,
    /// Quality it adds.
    pub boost: f64,
    /// Day on which it was completed.
    pub completed_day: Option<u32>,
}

canonical! {
    Project { tier, number, started_day, due_day, boost, completed_day }
}

impl Project {
    /// Identifier as stored in tables, for instance t3_1.
    pub fn id(&self) -> String {
        format!("t{}_{}", self.tier, self.number)
    }
}

/// A study in progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Study {
    /// Group.
    pub group: Group,
    /// Target level, 2..=5.
    pub target: u8,
    /// Level of the group when the study was ordered.
    pub before: u8,
    /// First day on which it is complete.
    pub due_day: u32,
}

canonical! { Study { group, target, before, due_day } }

impl Study {
    /// Returns whether the study refreshes the values without raising the level.
    pub fn is_refresh(&self) -> bool {
        self.target == self.before
    }
}

/// One attempt to discover a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attempt {
    /// Number of earlier attempts, including failed ones.
    pub earlier: u32,
    /// Dollars paid.
    pub cost: f64,
    /// The group that was discovered.
    pub found: Option<Group>,
}

canonical! { Attempt { earlier, cost, found } }

/// The player's knowledge of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knowledge {
    /// Study level, 0 while undiscovered.
    pub level: u8,
    /// Day of discovery.
    pub discovered_day: Option<u32>,
    /// Last day on which the level rose.
    pub last_research_day: Option<u32>,
    /// Values that estimates are based on, once the group is known.
    pub snapshot: Option<Snapshot>,
}

canonical! { Knowledge { level, discovered_day, last_research_day, snapshot } }

/// The drifting values of a group on a day. They are hidden; estimates are based on them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Snapshot {
    /// Day.
    pub day: u32,
    /// Mean budget, dollars a month.
    pub c_max: f64,
    /// Mean minimum quality.
    pub q_min: f64,
    /// Customers or accounts in the market.
    pub market_cap: f64,
}

canonical! { Snapshot { day, c_max, q_min, market_cap } }
