//! Values that are fixed at the start of a day.

use super::identifiers::{ByGroup, ByPlan, Group, Plan};
use super::settings::CoreSettings;
use crate::customers::drift::Expectation;
use crate::quality::delivered_quality;

/// Values that are fixed at the start of a day. For individuals, today's development, completed research, drift and
/// competitor moves take effect tomorrow.
#[derive(Debug, Clone)]
pub struct Morning {
    /// Day to which the values belong.
    pub day: u32,
    /// Core settings of the day.
    pub core: CoreSettings,
    /// Weekday factor of the calendar.
    pub weekday: f64,
    /// Day-of-month factor of the calendar.
    pub month_day: f64,
    /// Quota of each plan, units per day.
    pub quotas: ByPlan<f64>,
    /// Quality multiplier of each plan's model.
    pub multipliers: ByPlan<f64>,
    /// Product quality of each group, before the model's multiplier.
    pub product: ByGroup<f64>,
    /// Product quality without targeted development, before the model's multiplier.
    pub shared_quality: f64,
    /// Market drift of each group's curves.
    pub expectations: ByGroup<Expectation>,
    /// Number of active subscriptions of each group at the start of the day.
    pub subscribers: ByGroup<u32>,
}

impl Morning {
    /// Returns the delivered quality of a plan for a group, without today's service penalty.
    pub fn delivered(&self, group: Group, plan: Plan) -> f64 {
        delivered_quality(self.product[group], 0.0, 0.0, self.multipliers[plan])
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::params::Params;
    use crate::settings::Settings;

    /// Returns a morning with simple values for tests. A test can change each value.
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
