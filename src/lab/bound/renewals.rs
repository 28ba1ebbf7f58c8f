//! r: the share of a group's customers who are satisfied at a renewal.

use super::climate::Climate;
use super::premises::Premises;
use super::requirement::{required, risen};
use crate::normal::normal_share;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::product::development::targeted_development_gain;

/// Returns the renewal share on each renewal day, given targeted spending (dollars a day) and overload.
pub fn renewing(
    group: Group,
    spending: f64,
    overload: f64,
    climate: &Climate,
    premises: &Premises,
    params: &Params,
) -> Vec<f64> {
    let gain = targeted_development_gain(spending, &params.development);
    let model = params.model(premises.model_tier).quality_multiplier;
    let (mean, spread) = required(group, params);
    let share = |day: &u32| {
        let at = *day as usize;
        let targeted = gain * f64::from(day - 1);
        let quality = params.quality.base_product_quality + climate.shared[at] + targeted;
        let expected = risen(group, *day, climate, params) + gain * climate.copied[at][group];
        normal_share((model * quality - expected - overload - mean) / spread)
    };
    premises.renewals.iter().map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bound::climate::climate;

    #[test]
    fn a_renewal_follows_the_equation_of_the_paper() {
        let (premises, params) = (Premises::of_the_paper(3.0), Params::shipped());
        let (s1, calm) = (Group::parse("S1").expect("a group"), climate(&premises, &params));
        let own = renewing(s1, 5000.0, 0.05, &calm, &premises, &params);
        // Day 30: no competitor has acted, and 29 days of development have accumulated.
        let gain = 0.0225 * std::f64::consts::LN_2;
        let quality = 0.9 * (0.2 + calm.shared[30] + 29.0 * gain);
        let expected = normal_share((quality - 0.05 - 0.55) / 0.0125f64.sqrt());
        assert!((own[0] - expected).abs() < 1e-12, "{} {expected}", own[0]);
        assert_eq!(own.len(), 16);
    }
}
