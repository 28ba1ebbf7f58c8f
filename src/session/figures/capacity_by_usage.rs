//! Rules that set the capacity tier according to usage at the start of a week.

use novamind_record::figures::WeekFigures;
use novamind_world::params::{CapacityTier, Params};

const TARGET_UTILIZATION: f64 = 0.8;

/// A rule that sets the capacity tier according to usage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UsageCapacityRule {
    /// Select the smallest tier that serves the busiest day of the last week without overload, or the largest tier if
    /// none does. Before the first week, the tier does not change.
    BusiestDay,
    /// Move by one tier per week toward the smallest tier that serves the mean usage of the last week at 80 %
    /// utilization. Lessons and the routine in the paper use this rule.
    StepByStep,
}

impl UsageCapacityRule {
    /// Returns the capacity tier for the next week. `now` is the current tier, and `before` contains the figures of
    /// the last week.
    pub fn next_tier(self, now: u8, before: Option<&WeekFigures>, params: &Params) -> u8 {
        match self {
            UsageCapacityRule::BusiestDay => {
                before.map_or(now, |week| smallest_covering_tier(week.busiest_day as f64, now, params))
            }
            UsageCapacityRule::StepByStep => {
                let mean = before.map_or(0.0, |week| week.usage as f64 / f64::from(week.days_run.max(1)));
                let target = smallest_covering_tier(mean / TARGET_UTILIZATION, now, params);
                target.clamp(now.saturating_sub(1), now.saturating_add(1))
            }
        }
    }
}

/// Returns the smallest tier that serves `units` per day, or the largest tier if none does.
fn smallest_covering_tier(units: f64, now: u8, params: &Params) -> u8 {
    let tiers = &params.capacity_tier;
    let holds = |tier: &&CapacityTier| f64::from(tier.capacity_units) >= units;
    tiers.iter().find(holds).or(tiers.last()).map_or(now, |tier| tier.tier)
}
