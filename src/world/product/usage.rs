//! Usage of the service on one day (`docs/mechanics/product/usage.md`).

use crate::customers::Customers;
use crate::customers::columns::Block;
use crate::events::{Facts, UsageRows};
use crate::identifiers::{ByGroup, ByPlan, Plan};
use crate::morning::Morning;
use crate::params::{CustomerGeneration, Params, UsageQuota};

/// Usage of one day, in units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MeteredUsage {
    /// Units used by all customers.
    pub total: u64,
    /// Units used by plan, for compute costs.
    pub by_plan: ByPlan<u64>,
    /// Units used by group and plan.
    pub by_group: ByGroup<ByPlan<u64>>,
}

/// Returns the usage rate of a billing period, units per day for the whole account: max(0, N(u, 0.2 u)) times seats.
/// `z` is a standard normal draw.
#[inline]
pub fn usage_rate(usage_demand: f64, seats: f64, z: f64, bounds: &CustomerGeneration) -> f64 {
    let spread = bounds.daily_usage_rate_std_fraction * usage_demand;
    (usage_demand + spread * z).max(bounds.daily_usage_rate_min) * seats
}

/// Returns the usage of one account today: the usage rate times the weekday factor, limited by the quota, rounded half
/// away from zero.
#[inline]
pub fn usage_today(usage_rate: f64, weekday: f64, quota: f64) -> u32 {
    let limited = (usage_rate * weekday).min(quota.max(0.0));
    // Casting truncates, and the remainder decides whether to add 1. Below 2^32, the result equals rounding and is
    // faster.
    let whole = limited as u32;
    whole.saturating_add(u32::from(limited - f64::from(whole) >= 0.5))
}

/// Measures the usage of every active subscription. Records one row per subscription, even for 0 units.
pub fn measure_usage(
    customers: &mut Customers,
    morning: &Morning,
    params: &Params,
    facts: &mut Facts,
) -> MeteredUsage {
    let by_block = customers.sweep_light(|group, block| (group, measure_block_usage(block, morning, params)));
    let mut metered = MeteredUsage::default();
    for (group, (by_plan, rows)) in by_block {
        for plan in Plan::ALL {
            metered.by_plan[plan] += by_plan[plan];
            metered.by_group[group][plan] += by_plan[plan];
            metered.total += by_plan[plan];
        }
        facts.usage.push(rows);
    }
    metered
}

fn measure_block_usage(block: &mut Block, morning: &Morning, params: &Params) -> (ByPlan<u64>, UsageRows) {
    let mut by_plan = ByPlan([0u64; 3]);
    let per_period = params.fidelity.usage_quota == UsageQuota::Period;
    let (weekday, quotas) = (morning.weekday, morning.quotas);
    let rows = block.plan.iter().zip(&block.usage_rate).zip(&block.period_usage);
    let units: Vec<u32> = rows
        .map(|((&plan, &rate), &so_far)| {
            let quota = if per_period { (quotas[plan] - so_far as f64).max(0.0) } else { quotas[plan] };
            let used = usage_today(rate, weekday, quota);
            by_plan[plan] += u64::from(used);
            used
        })
        .collect();
    if per_period {
        block.period_usage.iter_mut().zip(&units).for_each(|(sum, used)| *sum += u64::from(*used));
    }
    (by_plan, UsageRows { customers: block.customer.clone(), units })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usage_rate_scales_with_demand_and_seats() {
        let bounds = Params::bundled().customer_generation;
        assert_eq!(usage_rate(80.0, 1.0, 1.0, &bounds), 96.0);
        assert_eq!(usage_rate(60.0, 100.0, 1.0, &bounds), 7200.0);
        assert_eq!(usage_rate(80.0, 1.0, -6.0, &bounds), 0.0);
    }

    #[test]
    fn usage_is_limited_by_quota_and_rounded_half_up() {
        // On a busy weekday, the quotas limit the first and the last account.
        assert_eq!(usage_today(80.0, 1.1, 60.0), 60);
        assert_eq!(usage_today(40.4, 1.1, 60.0), 44);
        assert_eq!(usage_today(75.0, 1.1, 100.0), 83);
        assert_eq!(usage_today(2.2727272727, 1.1, 100.0), 2);
        assert_eq!(usage_today(50.0, 1.1, 0.0), 0);
        assert_eq!(usage_today(2.5, 1.0, 100.0), 3);
        assert_eq!(usage_today(0.499_999_999_999_999_94, 1.0, 100.0), 0);
        assert_eq!(usage_today(50.0, 1.0, -5.0), 0);
        assert_eq!(usage_today(1e300, 1.0, 1e300), u32::MAX);
    }
}
