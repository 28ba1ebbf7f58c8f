//! The first decision of a customer: which plan a lead picks, whether an individual accepts the plan, and whether an
//! enterprise requests an offer (docs/mechanics/customers/choice.md).

use super::curve::{Curve, required_quality};
use crate::identifiers::{ByPlan, Plan};
use crate::params::Params;
use crate::quality::quota_factor;

/// A plan that is offered to the leads of a group today, before individual demand and discounts.
#[derive(Debug, Clone, Copy)]
pub struct PlanOffer {
    /// List price, dollars per month.
    pub price: f64,
    /// Delivered quality, less the service penalty if the fidelity parameter requires it.
    pub quality: f64,
    /// Quota of the plan, units per day.
    pub quota: f64,
}

/// The plan that a lead picks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanChoice {
    /// The plan with the largest surplus, or A if no surplus is positive.
    pub plan: Plan,
    /// Price of the plan after the first-bill discount, dollars per month.
    pub price: f64,
    /// Quality of the plan that the lead perceives, before noise.
    pub quality: f64,
}

/// Returns a plan with its discounted price and its quality after the quota factor.
pub fn evaluate_offer(
    offer: &PlanOffer,
    plan: Plan,
    discount: f64,
    demand: f64,
    params: &Params,
) -> PlanChoice {
    let price = (offer.price - discount).max(params.billing.effective_price_min);
    PlanChoice { plan, price, quality: offer.quality * quota_factor(offer.quota, demand, &params.quality) }
}

/// Picks the plan with the largest positive surplus, or plan A if no surplus is positive. On a tie, the earlier plan
/// wins.
///
/// Quotas are compared with `demand`. `curve` must already include the market's drift.
pub fn choose_plan(
    offers: &ByPlan<PlanOffer>,
    discount: f64,
    demand: f64,
    curve: &Curve,
    params: &Params,
) -> PlanChoice {
    let candidate = |plan| evaluate_offer(&offers[plan], plan, discount, demand, params);
    let mut best = (params.participation.lead_min_satisfaction_exclusive, None);
    for plan in Plan::ALL {
        let choice = candidate(plan);
        // The required quality is never below the minimum of the curve, so most plans need no further evaluation.
        let max = choice.quality - curve.q_min.min(curve.q_max);
        if choice.price > curve.c_max || max <= best.0 {
            continue;
        }
        let surplus = choice.quality - required_quality(choice.price, curve, params);
        if surplus > best.0 {
            best = (surplus, Some(choice));
        }
    }
    best.1.unwrap_or_else(|| candidate(Plan::A))
}

/// Returns whether an individual accepts the picked plan: the price is within the budget, and quality times noise is
/// at least the required quality.
pub fn is_accepted(choice: &PlanChoice, noise: f64, curve: &Curve, params: &Params) -> bool {
    choice.price <= curve.c_max && choice.quality * noise >= required_quality(choice.price, curve, params)
}

/// Returns whether any plan has sufficient quality for an enterprise at price 0, without noise.
pub fn passes_quality_gate(offers: &ByPlan<PlanOffer>, demand: f64, curve: &Curve, params: &Params) -> bool {
    let required = required_quality(0.0, curve, params);
    offers.iter().any(|offer| offer.quality * quota_factor(offer.quota, demand, &params.quality) >= required)
}

#[cfg(test)]
mod tests {
    use super::super::curve::tests::X;
    use super::*;
    use crate::quality::delivered_quality;

    fn offers(
        shared: f64,
        prices: [f64; 3],
        tiers: [u8; 3],
        quotas: [f64; 3],
        params: &Params,
    ) -> ByPlan<PlanOffer> {
        ByPlan::from_fn(|plan| {
            let at = plan.index();
            let multiplier = params.model_tier(tiers[at]).quality_multiplier;
            let quality = delivered_quality(params.quality.base_product_quality, shared, 0.0, multiplier);
            PlanOffer { price: prices[at], quality, quota: quotas[at] }
        })
    }

    const PRICES: [f64; 3] = [12.0, 25.0, 55.0];

    #[test]
    fn choose_plan_takes_the_largest_surplus_or_plan_a() {
        let params = Params::bundled();
        let market = |shared| offers(shared, PRICES, [1, 3, 5], [60.0, 100.0, 1200.0], &params);
        let weak = choose_plan(&market(0.0), 0.0, 80.0, &X, &params);
        assert_eq!((weak.plan, weak.price), (Plan::A, 12.0));
        assert!(!is_accepted(&weak, 1.0, &X, &params));
        let good = choose_plan(&market(0.2), 0.0, 80.0, &X, &params);
        assert_eq!((good.plan, good.price), (Plan::B, 25.0));
        assert!(is_accepted(&good, 1.0, &X, &params));
        assert!(!is_accepted(&good, 0.8, &X, &params));
        assert_eq!(choose_plan(&market(0.2), 7.0, 80.0, &X, &params).price, 18.0);
    }

    #[test]
    fn acceptance_depends_on_noise_and_budget() {
        let params = Params::bundled();
        let market = offers(0.12, PRICES, [1, 3, 5], [1000.0, 100.0, 1200.0], &params);
        let choice = choose_plan(&market, 0.0, 80.0, &X, &params);
        assert_eq!(choice.plan, Plan::A);
        assert!(!is_accepted(&choice, 1.0, &X, &params));
        assert!(is_accepted(&choice, 1.1, &X, &params));
        let at = |price| {
            let market = offers(0.4, [price; 3], [4, 1, 1], [1e9; 3], &params);
            let choice = choose_plan(&market, 0.0, 80.0, &X, &params);
            is_accepted(&choice, 1.0, &X, &params)
        };
        assert!(at(50.0));
        assert!(!at(50.01));
    }

    #[test]
    fn quality_gate_requires_quality_and_full_quota() {
        let params = Params::bundled();
        let k = Curve { steepness_left: 1.0, steepness_right: 2.0, c_max: 60.0, q_min: 0.5, q_max: 0.95 };
        for (product, tier, quota, passes) in [
            (0.6, 3, 1e9, true),
            (0.55, 3, 1e9, false),
            (0.6, 3, 4700.0, false),
            (0.6, 3, 4800.0, true),
            (0.9, 5, 2000.0, false),
        ] {
            let market = offers(product - 0.2, [1.0; 3], [tier; 3], [quota; 3], &params);
            assert_eq!(
                passes_quality_gate(&market, 5000.0, &k, &params),
                passes,
                "product quality {product}"
            );
        }
    }
}
