//! Delta and T: the quality gap of a group and the targeted development that closes it.

use super::climate::Climate;
use super::premises::Premises;
use super::requirement::{required, risen};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// Returns the widest gap over the renewals between the mean customer's required quality and shared quality, in
/// quality before the model's multiplier.
pub fn widest_gap(
    group: Group,
    overload: f64,
    climate: &Climate,
    premises: &Premises,
    params: &Params,
) -> f64 {
    let model = params.model(premises.model_tier).quality_multiplier;
    let (mean, _) = required(group, params);
    let gap = |day: &u32| {
        let shared = params.quality.base_product_quality + climate.shared[*day as usize];
        (mean + risen(group, *day, climate, params) + overload) / model - shared
    };
    premises.renewals.iter().map(gap).fold(0.0, f64::max)
}

/// Returns T0, the spending that closes a gap, dollars a day: scale (exp(gap / (counted share, mean age, gain)) - 1).
pub fn least_spending(gap: f64, premises: &Premises, params: &Params) -> f64 {
    let law = &params.development;
    let counted = premises.counted_gain * premises.mean_age() * law.targeted_dev_improvement_coef;
    law.targeted_dev_spend_scale * libm::expm1(gap / counted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::product::development::targeted_development_gain;

    #[test]
    fn the_least_spending_closes_the_gap_as_it_is_counted() {
        let (premises, params) = (Premises::of_the_paper(1.0), Params::shipped());
        for gap in [0.5, 4.0, 9.0] {
            let gain =
                targeted_development_gain(least_spending(gap, &premises, &params), &params.development);
            assert!((0.7 * 248.5 * gain - gap).abs() < 1e-9);
        }
        assert_eq!(least_spending(0.0, &premises, &params), 0.0);
    }
}
