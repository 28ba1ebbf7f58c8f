//! Values fixed at the start of a day.

use super::identifiers::{ByGroup, ByPlan, Group, Plan};
use super::settings::CoreSettings;
use crate::customers::drift::Expectation;
use crate::quality::delivered_quality;

/// Values fixed at the start of a day. Today's improvements, completed research, drift and competitor moves
/// affect individuals from tomorrow.
#[derive(Debug, Clone)]
pub struct Morning {
    /// Day.
    pub day: u32,
    /// Settings in force.
    pub core: CoreSettings,
    /// Factor of the weekday.
    pub weekday: f64,
    /// Factor of the day of the month.
    pub month_day: f64,
    /// Quotas in units.
    pub quotas: ByPlan<f64>,
    /// Quality multiplier of each plan's model.
    pub multipliers: ByPlan<f64>,
    /// Product quality by group before the multiplier.
    pub product: ByGroup<f64>,
    /// Product quality before the multiplier and without targeted development.
    pub shared_quality: f64,
    /// The market's change of curves.
    pub expectations: ByGroup<Expectation>,
    /// Active subscriptions.
    pub subscribers: ByGroup<u32>,
}

impl Morning {
    /// Returns the quality delivered to a group on a plan, without today's service penalty.
    pub fn delivered(&self, group: Group, plan: Plan) -> f64 {
        delivered_quality(self.product[group], 0.0, 0.0, self.multipliers[plan])
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::params::Params;
    use crate::settings::Settings;

    /// A morning with simple values; tests change what they need.
    pub(crate) fn morning(day: u32) -> Morning {
        let params = Params::bundled();
        Morning {
            day,
            core: Settings::initial(&params).core,
            weekday: params.calendar.weekly[(day % 7) as usize],
            month_day: params.calendar.monthly[(day % 30) as usize],
            quotas: ByPlan([0.0; 3]),
            multipliers: ByPlan([0.6; 3]),
            product: ByGroup::from_fn(|_| 0.2),
            shared_quality: 0.2,
            expectations: ByGroup::default(),
            subscribers: ByGroup::default(),
        }
    }
}
