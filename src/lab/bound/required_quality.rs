//! mu, sigma and d: the distribution of the quality required at the highest price, and the increase of its
//! mean up to a day.

use super::shared_quality::SharedQualityPath;
use novamind_world::customers::drift::{global_drift_step, group_drift_step, is_drift_day};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// Returns the mean and the standard deviation of the quality that a group requires at the budget.
pub fn required_quality(group: Group, params: &Params) -> (f64, f64) {
    let group_params = params.group(group);
    (
        group_params.q_min_mean + group_params.q_range_mean,
        libm::hypot(group_params.q_min_std, group_params.q_range_std),
    )
}

/// Returns by how much competitors and drift have raised a group's expectations up to a day. Excludes the quality that
/// competitors copy from the group's quality bank.
pub fn added_expectation(group: Group, day: u32, quality_path: &SharedQualityPath, params: &Params) -> f64 {
    let applied = (1..day).filter(|day| is_drift_day(*day, &params.drift)).count() as f64;
    let drift_increase =
        applied * (group_drift_step(group, params).quality + global_drift_step(&params.drift));
    let reaction = params.group(group).competitor_reactivity_q_bias;
    quality_path.raised_expectations[day as usize] * (1.0 + reaction) + drift_increase
}

/// Returns the quality that customers lose to overload.
pub fn overload_penalty(daily_usage: f64, capacity_tier: u8, params: &Params) -> f64 {
    let capacity = f64::from(params.capacity_tier(capacity_tier).capacity_units);
    let strain = (daily_usage / capacity - params.operations.overload_reference_utilization).max(0.0);
    params.quality.service_overload_weight * strain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_usage_exceeds_the_largest_capacity() {
        let params = Params::bundled();
        let penalty = overload_penalty(521e6, 7, &params);
        assert!((penalty - 0.08 * (521.0 / 300.0 - 1.0)).abs() < 1e-12);
        assert_eq!(overload_penalty(299e6, 7, &params), 0.0);
    }

    #[test]
    fn required_quality_is_floor_plus_range() {
        let (mean, spread) = required_quality(Group::parse("S1").expect("a group"), &Params::bundled());
        assert!((mean - 0.55).abs() < 1e-12 && (spread - 0.0125f64.sqrt()).abs() < 1e-12);
    }
}
