//! Delta and T: the quality gap of a group and the targeted development that closes the gap.

use super::assumptions::BoundAssumptions;
use super::required_quality::{added_expectation, required_quality};
use super::shared_quality::SharedQualityPath;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// Returns the largest gap, over all renewal days, between shared quality and the quality that the mean customer
/// requires. The unit is quality before the multiplier of the model tier.
pub fn widest_gap(
    group: Group,
    overload: f64,
    quality_path: &SharedQualityPath,
    premises: &BoundAssumptions,
    params: &Params,
) -> f64 {
    let model = params.model_tier(premises.model_tier).quality_multiplier;
    let (mean, _) = required_quality(group, params);
    let gap = |day: &u32| {
        let shared = params.quality.base_product_quality + quality_path.shared[*day as usize];
        (mean + added_expectation(group, *day, quality_path, params) + overload) / model - shared
    };
    premises.renewals.iter().map(gap).fold(0.0, f64::max)
}

/// Returns T0, the spending that closes a gap, $ per day:
/// scale (exp(gap / (counted share * mean age * coefficient)) - 1).
pub fn min_spending(gap: f64, premises: &BoundAssumptions, params: &Params) -> f64 {
    let development = &params.development;
    let counted =
        premises.counted_gain * premises.mean_spending_age() * development.targeted_dev_improvement_coef;
    development.targeted_dev_spend_scale * libm::expm1(gap / counted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::product::development::targeted_development_gain;

    #[test]
    fn min_spending_closes_the_gap() {
        let (premises, params) = (BoundAssumptions::from_paper(1.0), Params::bundled());
        for gap in [0.5, 4.0, 9.0] {
            let gain = targeted_development_gain(min_spending(gap, &premises, &params), &params.development);
            assert!((0.7 * 248.5 * gain - gap).abs() < 1e-9);
        }
        assert_eq!(min_spending(0.0, &premises, &params), 0.0);
    }
}
