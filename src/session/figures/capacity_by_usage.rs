//! Rules by which the capacity follows usage: what is set at the start of a week.

use novamind_record::figures::WeekFigures;
use novamind_world::params::{CapacityTier, Params};

/// Share of the capacity that mean use is to take.
const UTILISATION: f64 = 0.8;

/// A rule by which the capacity follows usage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UsageRule {
    /// The smallest tier that serves the busiest day of the week before without overload; the largest where none does. Nothing
    /// moves before the first week.
    BusiestDay,
    /// One tier a week towards the smallest that holds the mean use of the week before at 80 %, as the routine of the paper and
    /// lessons have it.
    StepByStep,
}

impl UsageRule {
    /// The tier that the rule sets after a week, given the one in force.
    pub fn tier(self, now: u8, before: Option<&WeekFigures>, params: &Params) -> u8 {
        match self {
            UsageRule::BusiestDay => {
                before.map_or(now, |week| covering(week.busiest_day as f64, now, params))
            }
            UsageRule::StepByStep => {
                let mean = before.map_or(0.0, |week| week.usage as f64 / f64::from(week.days_run.max(1)));
                let target = covering(mean / UTILISATION, now, params);
                target.clamp(now.saturating_sub(1), now.saturating_add(1))
            }
        }
    }
}

/// The smallest tier that serves so many units a day; the largest where none does.
fn covering(units: f64, now: u8, params: &Params) -> u8 {
    let tiers = &params.capacity_tier;
    let holds = |tier: &&CapacityTier| f64::from(tier.capacity_units) >= units;
    tiers.iter().find(holds).or(tiers.last()).map_or(now, |tier| tier.tier)
}
