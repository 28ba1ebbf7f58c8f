//! Facts about research: R&D projects, market studies, and attempts to discover a group.

use crate::canonical::canonical;
use crate::identifiers::Group;

/// An R&D project.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Project {
    /// Tier of the project, 1..=20.
    pub tier: u8,
    /// Number of the project within its tier, from 1.
    pub number: u32,
    /// Day on which the project was started.
    pub started_day: u32,
    /// Day on which the project is completed.
    pub due_day: u32,
    /// Quality that the project adds.
    pub boost: f64,
    /// Day on which the project was completed; `None` for a project in progress.
    pub completed_day: Option<u32>,
}

canonical! {
    Project { tier, number, started_day, due_day, boost, completed_day }
}

impl Project {
    /// Returns the identifier that tables use for the project, for instance `t3_1`.
    pub fn id(&self) -> String {
        format!("t{}_{}", self.tier, self.number)
    }
}

/// A market study in progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Study {
    /// Group whose estimates the study updates.
    pub group: Group,
    /// Study level that the study reaches, 2..=5.
    pub target: u8,
    /// Study level of the group when the study was bought.
    pub before: u8,
    /// Day on which the study is completed.
    pub due_day: u32,
}

canonical! { Study { group, target, before, due_day } }

impl Study {
    /// Returns whether the study refreshes the estimates without raising the study level.
    pub fn is_refresh(&self) -> bool {
        self.target == self.before
    }
}

/// A paid attempt to discover a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attempt {
    /// Number of earlier attempts, including failed ones.
    pub earlier: u32,
    /// Price of the attempt, dollars.
    pub cost: f64,
    /// The discovered group, or `None` if the attempt failed.
    pub found: Option<Group>,
}

canonical! { Attempt { earlier, cost, found } }

/// The player's knowledge of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knowledge {
    /// Study level of the group; 0 before its discovery.
    pub level: u8,
    /// Day on which the group was discovered; 0 for a group that is known initially, `None` for an unknown group.
    pub discovered_day: Option<u32>,
    /// Last day on which the study level rose.
    pub last_research_day: Option<u32>,
    /// True values on which estimates are based; `None` for an unknown group.
    pub snapshot: Option<Snapshot>,
}

canonical! { Knowledge { level, discovered_day, last_research_day, snapshot } }

/// The true values of a group on one day, from which estimates are computed. Hidden from the player.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Snapshot {
    /// Day on which the values were taken.
    pub day: u32,
    /// Mean budget, dollars per month.
    pub c_max: f64,
    /// Mean minimum quality in the group.
    pub q_min: f64,
    /// Size of the group's market, in individuals or enterprises.
    pub market_cap: f64,
}

canonical! { Snapshot { day, c_max, q_min, market_cap } }
