//! r: the share of a group's customers who are satisfied at a renewal.

use super::assumptions::BoundAssumptions;
use super::required_quality::{added_expectation, required_quality};
use super::shared_quality::SharedQualityPath;
use crate::normal_distribution::normal_cdf;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::product::development::targeted_development_gain;

/// Returns the share of customers who renew, for each renewal day. `spending` is the group's targeted development in $
/// per day, and `overload` is the quality lost to overload.
pub fn renewal_shares(
    group: Group,
    spending: f64,
    overload: f64,
    quality_path: &SharedQualityPath,
    premises: &BoundAssumptions,
    params: &Params,
) -> Vec<f64> {
    let gain = targeted_development_gain(spending, &params.development);
    let model = params.model_tier(premises.model_tier).quality_multiplier;
    let (mean, spread) = required_quality(group, params);
    let share = |day: &u32| {
        let at = *day as usize;
        let targeted = gain * f64::from(day - 1);
        let quality = params.quality.base_product_quality + quality_path.shared[at] + targeted;
        let expected = added_expectation(group, *day, quality_path, params)
            + gain * quality_path.copied_quality[at][group];
        normal_cdf((model * quality - expected - overload - mean) / spread)
    };
    premises.renewals.iter().map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bound::shared_quality::shared_quality_path;

    #[test]
    fn renewal_share_follows_the_paper() {
        let (premises, params) = (BoundAssumptions::from_paper(3.0), Params::bundled());
        let (s1, calm) = (Group::parse("S1").expect("a group"), shared_quality_path(&premises, &params));
        let values = renewal_shares(s1, 5000.0, 0.05, &calm, &premises, &params);
        // On day 30, no competitor has moved yet, and development has accumulated for 29 days.
        let gain = 0.0225 * std::f64::consts::LN_2;
        let quality = 0.9 * (0.2 + calm.shared[30] + 29.0 * gain);
        let expected = normal_cdf((quality - 0.05 - 0.55) / 0.0125f64.sqrt());
        assert!((values[0] - expected).abs() < 1e-12, "{} {expected}", values[0]);
        assert_eq!(values.len(), 16);
    }
}
