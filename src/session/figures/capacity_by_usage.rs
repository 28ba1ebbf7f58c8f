//! The capacity that follows usage: one tier a week, as the routine of the paper and lessons have it.

use std::cmp::Ordering;

use crate::session::state::Session;
use crate::world::params::CapacityTier;

/// Share of the capacity that usage is to take.
const UTILISATION: f64 = 0.8;

impl Session {
    /// The capacity tier one step towards the smallest that holds the mean use of the last week.
    pub fn capacity_towards_usage(&self) -> u8 {
        let now = self.simulation.world.settings.core.capacity_tier;
        let mean =
            self.history.weeks.last().map_or(0.0, |week| week.usage as f64 / f64::from(week.days_run.max(1)));
        let tiers = &self.simulation.params.capacity_tier;
        let holds = |tier: &&CapacityTier| f64::from(tier.capacity_units) >= mean / UTILISATION;
        let target = tiers.iter().find(holds).or(tiers.last()).map_or(now, |tier| tier.tier);
        match now.cmp(&target) {
            Ordering::Less => now + 1,
            Ordering::Equal => now,
            Ordering::Greater => now - 1,
        }
    }
}
