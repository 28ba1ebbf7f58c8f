//! An individual's decision, split into terms, and the terms that determined the decision.

use serde::Serialize;

use novamind_world::customers::curve::{Curve, required_quality};
use novamind_world::identifiers::{ByPlan, Plan};
use novamind_world::params::Params;
use novamind_world::quality::QualityTerms;
use novamind_world::retention::plan_comparison::PlanComparison;

/// An individual's evaluation of a plan on a billing day.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct RenewalPlanTerms {
    /// Price after the ongoing discount, $ per month.
    pub price: f64,
    /// Terms of the perceived quality.
    #[serde(flatten)]
    pub experience: QualityTerms,
    /// Perceived quality of the plan, computed from the terms in `experience`.
    pub quality: f64,
    /// Required quality at the plan's price.
    pub required: f64,
    /// Perceived quality minus required quality.
    pub surplus: f64,
    /// Whether the plan's price is within the budget. An acceptable plan is within the budget and has a surplus of at
    /// least 0.
    pub within_budget: bool,
}

/// An input of a decision. The decision can be evaluated without the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecisionTerm {
    /// Effect of an open issue.
    Issue,
    /// Effect of in-app advertising.
    Ads,
    /// Effect of a quota below the demand.
    Quota,
    /// Effect of the relationship to the company.
    Relationship,
    /// Effect of the tenure of the subscription.
    Tenure,
    /// Effect of the day's outages and overload.
    Service,
    /// Increase in the required quality due to drift and competitors.
    Expectations,
    /// Drift of the budget.
    Budgets,
    /// Effect of the economy on the budget.
    Economy,
    /// Changes in list prices and discounts since the last bill.
    Prices,
}

impl DecisionTerm {
    /// All terms. Decisive terms with equal surpluses are listed in this order.
    pub const ALL: [DecisionTerm; 10] = [
        DecisionTerm::Issue,
        DecisionTerm::Ads,
        DecisionTerm::Quota,
        DecisionTerm::Relationship,
        DecisionTerm::Tenure,
        DecisionTerm::Service,
        DecisionTerm::Expectations,
        DecisionTerm::Budgets,
        DecisionTerm::Economy,
        DecisionTerm::Prices,
    ];

    /// Returns the decision that the individual would make without the term, or `None` if the term has no effect.
    /// `last_bill` contains the price of each plan at the last bill.
    fn without_term(
        self,
        weighing: &PlanComparison,
        last_bill: Option<&ByPlan<f64>>,
    ) -> Option<PlanComparison> {
        let mut other = *weighing;
        let mut each = |change: &dyn Fn(&mut QualityTerms)| other.experiences.0.iter_mut().for_each(change);
        match self {
            DecisionTerm::Issue => each(&|experience| experience.issues = 0.0),
            DecisionTerm::Ads => each(&|experience| experience.ads = 0.0),
            DecisionTerm::Quota => each(&|experience| experience.quota = 1.0),
            DecisionTerm::Relationship => each(&|experience| experience.relationship = 0.0),
            DecisionTerm::Tenure => each(&|experience| experience.tenure = 0.0),
            DecisionTerm::Service => each(&|experience| experience.delivered += weighing.service_penalty),
            DecisionTerm::Expectations => other.expectation.quality = 0.0,
            DecisionTerm::Budgets => other.expectation.c_max = 0.0,
            DecisionTerm::Economy => other.willingness_to_pay = 1.0,
            DecisionTerm::Prices => other.prices = *last_bill?,
        }
        Some(other)
    }
}

/// A decisive term, with the decision that the individual would make without the term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecisiveTerm {
    /// The term whose removal reverses the decision.
    pub term: DecisionTerm,
    /// Best plan without the term, with its surplus; `None` if no plan is acceptable.
    pub plan: Option<(Plan, f64)>,
}

/// An evaluated decision of an individual.
#[derive(Debug, Clone)]
pub struct WeighedDecision {
    /// The individual's evaluation of each plan.
    pub plans: ByPlan<RenewalPlanTerms>,
    /// Participation curve, including market expectations and the economy.
    pub curve: Curve,
    /// Best acceptable plan; `None` if no plan is acceptable.
    pub choice: Option<Plan>,
    /// Terms whose removal, one at a time, reverses the decision to stay or cancel. If the decision is to cancel, the
    /// terms are sorted by the surplus of the best plan without the term, largest first.
    pub decisive_terms: Vec<DecisiveTerm>,
}

impl WeighedDecision {
    /// Computes the terms of a decision from a comparison of plans.
    pub(crate) fn new(
        weighing: &PlanComparison,
        last_bill: Option<&ByPlan<f64>>,
        params: &Params,
    ) -> WeighedDecision {
        let curve = weighing.curve(params);
        let qualities = weighing.qualities(params);
        let plans = ByPlan::from_fn(|plan| {
            let price = weighing.prices[plan];
            RenewalPlanTerms {
                price,
                experience: weighing.experiences[plan],
                quality: qualities[plan],
                required: required_quality(price, &curve, params),
                surplus: weighing.surplus(plan, params),
                within_budget: price <= curve.c_max,
            }
        });
        let choice = weighing.choice(params);
        let without = |term: DecisionTerm| {
            let other = term.without_term(weighing, last_bill)?;
            let plan = other.choice(params).map(|plan| (plan, other.surplus(plan, params)));
            (plan.is_some() != choice.is_some()).then_some(DecisiveTerm { term, plan })
        };
        let mut turning: Vec<DecisiveTerm> = DecisionTerm::ALL.into_iter().filter_map(without).collect();
        let surplus = |without: &DecisiveTerm| without.plan.map_or(0.0, |(_, surplus)| surplus);
        turning.sort_by(|one, other| surplus(other).total_cmp(&surplus(one)));
        WeighedDecision { plans, curve, choice, decisive_terms: turning }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Mutex;

    use super::*;
    use novamind_world::customers::columns::Block;
    use novamind_world::day::observer::DayObserver;
    use novamind_world::day::step_day_observed;
    use novamind_world::events::{EndCause, Facts};
    use novamind_world::fixed_inputs::FixedInputs;
    use novamind_world::identifiers::{Channel, Group};
    use novamind_world::random::Streams;
    use novamind_world::retention::due_today;
    use novamind_world::retention::plan_comparison::compare_plans;
    use novamind_world::retention::renewal::RenewalContext;
    use novamind_world::settings::PerGroup;
    use novamind_world::state::World;

    /// A decision: the plan at the start of the day, whether satisfaction was negative, and the evaluation.
    struct ObservedDecision {
        plan: Plan,
        is_unhappy: bool,
        weighed: WeighedDecision,
        has_late_issue: bool,
    }

    /// An observer that splits the decisions of all individuals into terms.
    #[derive(Default)]
    struct DecisionObserver(Mutex<BTreeMap<u32, ObservedDecision>>);

    impl DayObserver for DecisionObserver {
        fn before_decisions(&self, group: Group, block: &Block, judgement: &RenewalContext<'_>) {
            if group.is_enterprise() {
                return;
            }
            let params = judgement.day.params;
            for at in due_today(block, judgement.day.day(), params) {
                let weighed = WeighedDecision::new(&compare_plans(group, block, at, judgement), None, params);
                let is_unhappy = block.satisfaction[at] < 0.0;
                let has_late_issue = block.open_issue_days[at] > 3;
                let seen = ObservedDecision { plan: block.plan[at], is_unhappy, weighed, has_late_issue };
                self.0.lock().expect("a lock").insert(block.customer[at], seen);
            }
        }
    }

    /// Changes prices, quotas and ads frequently in a company with many subscribers.
    fn change_settings(world: &mut World, day: u32) {
        let step = f64::from(day % 11);
        let core = &mut world.settings.core;
        core.prices.0 = [8.0 + step, 16.0 + 2.0 * step, 40.0 + 3.0 * step];
        core.tiers.0 = [2, 4, 5];
        core.capacity_tier = 7;
        world.settings.ads_strength.global = f64::from(day % 3) * 0.1;
        world.settings.promotion.global = f64::from(day % 4);
        let groups = ["S1", "S2", "S3"].map(|id| (Group::parse(id).expect("a group"), 8000.0));
        world.settings.targeted_ads.targeted_spend.insert(Channel::ContentMarketing, PerGroup::from(groups));
    }

    #[test]
    fn weighed_decisions_match_simulated_decisions() {
        let (params, streams) = (Params::bundled(), Streams::new(11));
        let mut facts = Facts::default();
        let mut world = World::new(500, 1e12, &params, &mut facts);
        novamind_world::test_kit::apply_policy_p(&mut world);
        let everybody = DecisionObserver::default();
        let (mut judged, mut left, mut switched, mut turned_by_issue) = (0, 0, 0, 0);
        while judged < 100_000 {
            let tomorrow = world.day + 1;
            change_settings(&mut world, tomorrow);
            step_day_observed(&mut world, &params, &streams, &FixedInputs::default(), &mut facts, &everybody);
            let seen = std::mem::take(&mut *everybody.0.lock().expect("a lock"));
            let ended: BTreeMap<u32, EndCause> =
                facts.endings.iter().map(|ending| (ending.customer, ending.cause)).collect();
            let plans: BTreeMap<u32, Plan> =
                facts.changes.iter().map(|change| (change.customer, change.plan)).collect();
            for (customer, ObservedDecision { plan, is_unhappy, weighed, has_late_issue }) in seen {
                assert_terms_add_up(&weighed);
                let outcome = ended.get(&customer);
                if outcome == Some(&EndCause::Involuntary) {
                    continue;
                }
                judged += 1;
                let expected = match (weighed.choice, is_unhappy) {
                    (Some(_), _) => None,
                    (None, true) => Some(&EndCause::Quality),
                    (None, false) => Some(&EndCause::Price),
                };
                assert_eq!(outcome, expected, "customer {customer} on day {}", world.day);
                left += u32::from(expected.is_some());
                if let Some(chosen) = weighed.choice {
                    assert_eq!(*plans.get(&customer).unwrap_or(&plan), chosen, "customer {customer}");
                    switched += u32::from(chosen != plan);
                }
                let issue = weighed.decisive_terms.iter().any(|without| without.term == DecisionTerm::Issue);
                turned_by_issue += u32::from(issue && weighed.choice.is_none());
                assert!(!issue || has_late_issue || weighed.plans[Plan::A].experience.issues > 0.0);
            }
        }
        assert!(left > 2000 && switched > 2000 && turned_by_issue > 0, "{left} {switched} {turned_by_issue}");
    }

    /// Asserts that the terms of each plan add up bit for bit to the value that the simulator compared.
    fn assert_terms_add_up(weighed: &WeighedDecision) {
        for plan_terms in weighed.plans.iter() {
            let QualityTerms { delivered, relationship, tenure, quota, issues, ads } = plan_terms.experience;
            let quality = (delivered + relationship + tenure) * quota - issues - ads;
            assert_eq!(quality.to_bits(), plan_terms.quality.to_bits());
            assert_eq!((plan_terms.quality - plan_terms.required).to_bits(), plan_terms.surplus.to_bits());
        }
        let acceptable = |plan: Plan| weighed.plans[plan].within_budget && weighed.plans[plan].surplus >= 0.0;
        assert_eq!(Plan::ALL.into_iter().any(acceptable), weighed.choice.is_some());
        assert!(weighed.choice.is_none_or(acceptable));
        assert!(
            weighed.decisive_terms.iter().all(|without| without.plan.is_some() == weighed.choice.is_none())
        );
    }
}
