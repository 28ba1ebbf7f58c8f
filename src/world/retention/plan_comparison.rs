//! The comparison of plans that determines whether an individual stays (`docs/mechanics/retention/renewal.md`).

use super::renewal::{RenewalContext, ongoing_discount};
use crate::context::DayContext;
use crate::customers::columns::Block;
use crate::customers::curve::{Curve, required_quality};
use crate::customers::drift::Expectation;
use crate::identifiers::{ByPlan, Group, Plan};
use crate::params::{Params, RenewalPrice, ServicePenalty};
use crate::quality::{QualityTerms, perceived_quality, quota_demand, quota_factor, relationship_bonus};

/// Prices and qualities of the plans for an individual, and the individual's requirements.
#[derive(Debug, Clone, Copy)]
pub struct PlanComparison {
    /// List prices less the ongoing discounts, dollars per month. The list prices are today's, except for the current
    /// plan: `fidelity.renewal_price` can select the stored price if the stored price is lower.
    pub prices: ByPlan<f64>,
    /// Terms of the perceived quality of each plan.
    pub experiences: ByPlan<QualityTerms>,
    /// Quality loss from today's service, which the delivered quality already includes.
    pub service_penalty: f64,
    /// Participation curve of the individual, without market drift.
    pub own_curve: Curve,
    /// Market drift of the curve.
    pub expectation: Expectation,
    /// Macroeconomic multiplier of the budget.
    pub willingness_to_pay: f64,
}

/// Creates the comparison of plans for the individual at a position of a block.
pub fn compare_plans(group: Group, block: &Block, at: usize, context: &RenewalContext<'_>) -> PlanComparison {
    let &DayContext { morning, settings, params, .. } = context.day;
    let service_penalty = match params.fidelity.service_penalty {
        ServicePenalty::Satisfaction => 0.0,
        ServicePenalty::Everywhere => context.day.service_penalty,
    };
    let prices = ByPlan::from_fn(|plan| {
        let discount = ongoing_discount(block.customer[at], group, plan, settings, params);
        let list = morning.core.prices[plan];
        let listed = match params.fidelity.renewal_price {
            RenewalPrice::LowerOfListAndStored if plan == block.plan[at] => list.min(block.listed_price[at]),
            _ => list,
        };
        (listed - discount).max(params.billing.effective_price_min)
    });
    let quality = &params.quality;
    let rate = block.usage_rate[at];
    let demand = quota_demand(rate * morning.weekday, rate, params);
    // See `docs/mechanics/product/quality.md#terms-of-each-decision`.
    let experiences = ByPlan::from_fn(|plan| QualityTerms {
        delivered: morning.delivered(group, plan) - service_penalty,
        relationship: relationship_bonus(block.relationship[at], quality),
        tenure: context.day.tenure.bonus(morning.day - block.start_day[at]),
        quota: quota_factor(morning.quotas[plan], demand, quality),
        issues: quality.issue_penalty_per_open_day * f64::from(block.open_issue_days[at]),
        ads: block.ads_quality_sensitivity[at] * context.day.ads.for_group(group),
    });
    PlanComparison {
        prices,
        experiences,
        service_penalty,
        own_curve: block.curve(at),
        expectation: morning.expectations[group],
        willingness_to_pay: context.willingness_to_pay[group],
    }
}

impl PlanComparison {
    /// Returns the perceived quality of each plan.
    pub fn qualities(&self, params: &Params) -> ByPlan<f64> {
        ByPlan::from_fn(|plan| perceived_quality(self.experiences[plan], params.fidelity.perceived_quality))
    }

    /// Returns the curve with market drift, and with the effect of the economy on the budget.
    pub fn curve(&self, params: &Params) -> Curve {
        let curve = drifted_curve(self.own_curve, self.expectation, params);
        curve.with_budget(curve.c_max * self.willingness_to_pay)
    }

    /// Returns the best acceptable plan, or `None` if no plan is acceptable.
    pub fn choice(&self, params: &Params) -> Option<Plan> {
        best_plan(&self.prices, &self.qualities(params), &self.curve(params), params)
    }

    /// Returns the surplus of a plan. A plan is acceptable if its surplus is at least 0 and its price is within the
    /// budget.
    pub fn surplus(&self, plan: Plan, params: &Params) -> f64 {
        let quality = perceived_quality(self.experiences[plan], params.fidelity.perceived_quality);
        quality - required_quality(self.prices[plan], &self.curve(params), params)
    }
}

/// Returns the curve of an individual with market drift.
pub fn drifted_curve(curve: Curve, expectation: Expectation, params: &Params) -> Curve {
    curve.with_drift(expectation.quality, expectation.c_max, params.quality.read_time_c_max_min)
}

/// Returns the acceptable plan with the largest surplus, or `None` if no plan is acceptable. On a tie, the earlier plan
/// wins.
///
/// A plan is acceptable if its price is within the budget of the curve and its quality is at least the
/// required quality.
pub fn best_plan(
    prices: &ByPlan<f64>,
    qualities: &ByPlan<f64>,
    curve: &Curve,
    params: &Params,
) -> Option<Plan> {
    let mut best: Option<(f64, Plan)> = None;
    for plan in Plan::ALL {
        // The required quality is never below the minimum of the curve, so most plans need no further evaluation.
        let max = qualities[plan] - curve.q_min.min(curve.q_max);
        if prices[plan] > curve.c_max || max < 0.0 || best.is_some_and(|(surplus, _)| max <= surplus) {
            continue;
        }
        let surplus = qualities[plan] - required_quality(prices[plan], curve, params);
        if surplus >= 0.0 && best.is_none_or(|(max, _)| surplus > max) {
            best = Some((surplus, plan));
        }
    }
    best.map(|(_, plan)| plan)
}
