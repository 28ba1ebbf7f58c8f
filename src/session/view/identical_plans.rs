//! Detection of plans that differ only in price, so that the more expensive plan has no benefit.

use serde::Serialize;

use super::CompanyView;
use novamind_world::identifiers::{ByPlan, Group, Plan};
use novamind_world::settings::{PerPlan, Settings};

/// Two plans with the same model tier, quota, discounts and targeted operations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct IdenticalPlans {
    /// The less expensive plan, or the first plan if the prices are equal.
    pub cheap: Plan,
    /// The more expensive plan, or the second plan if the prices are equal.
    pub expensive: Plan,
    /// List price of the less expensive plan, dollars per month.
    pub cheap_price: f64,
    /// List price of the more expensive plan, dollars per month.
    pub expensive_price: f64,
    /// Active subscriptions to the more expensive plan.
    pub subscribers: u32,
    /// Whether the plans already differed only in price at the end of the last week.
    pub before: bool,
}

impl CompanyView<'_> {
    /// Returns the pairs of plans on sale that differ only in price, according to the settings in force from the next
    /// day.
    pub(crate) fn identical_plans(&self) -> Vec<IdenticalPlans> {
        let (now, before) = (&self.simulation.world.settings, &self.history.week_actions.settings);
        let pairs = [(Plan::A, Plan::B), (Plan::A, Plan::C), (Plan::B, Plan::C)];
        let alike = pairs.into_iter().filter(|(left, right)| are_identical(now, *left, *right));
        let of = |(left, right): (Plan, Plan)| {
            let prices = now.core.prices;
            let (cheap, expensive) = if prices[right] < prices[left] { (right, left) } else { (left, right) };
            IdenticalPlans {
                cheap,
                expensive,
                cheap_price: prices[cheap],
                expensive_price: prices[expensive],
                subscribers: self.subscriptions_by_plan()[expensive],
                before: are_identical(before, left, right),
            }
        };
        alike.map(of).collect()
    }

    fn subscriptions_by_plan(&self) -> ByPlan<u32> {
        let mut subscriptions = ByPlan([0; 3]);
        for (_, block) in self.simulation.world.customers.blocks() {
            block.plan.iter().for_each(|plan| subscriptions[*plan] += 1);
        }
        subscriptions
    }
}

fn are_identical(settings: &Settings, left: Plan, right: Plan) -> bool {
    let (core, operations) = (&settings.core, &settings.targeted_operations);
    let of = |plans: Option<&PerPlan>, plan: Plan| {
        plans.and_then(|values| values.get(&plan)).copied().unwrap_or(0.0)
    };
    let by_group = |group: Group| {
        [&settings.promotion.by_group_plan, &operations.by_group_plan]
            .into_iter()
            .all(|scope| of(scope.get(&group), left) == of(scope.get(&group), right))
    };
    core.prices[left] > 0.0
        && core.prices[right] > 0.0
        && core.tiers[left] == core.tiers[right]
        && core.quotas[left].units() == core.quotas[right].units()
        && of(Some(&operations.by_plan), left) == of(Some(&operations.by_plan), right)
        && Group::all().all(by_group)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::play::Session;
    use crate::{NewRun, Storage};
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::trajectory::record::Via;

    #[test]
    fn plans_with_any_different_setting_are_not_identical() {
        let new = NewRun { storage: Storage::Memory, projection: false, ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        let mut alike = |tool: &str, arguments: serde_json::Value| {
            session
                .call(tool, &arguments, Via::Script)
                .unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
            session
                .company()
                .identical_plans()
                .iter()
                .map(|identical_plans| (identical_plans.cheap, identical_plans.expensive))
                .collect::<Vec<(Plan, Plan)>>()
        };
        let all = [(Plan::A, Plan::B), (Plan::A, Plan::C), (Plan::B, Plan::C)];
        assert_eq!(alike("set_usage_quotas", json!({"A": 9, "B": 9, "C": 9})), [], "no plan has a price");
        assert_eq!(alike("set_prices", json!({"B": 25, "C": 55})), [(Plan::B, Plan::C)]);
        assert_eq!(alike("set_prices", json!({"A": 12})), all);
        let [a_b, a_c, b_c] = all;
        assert_eq!(alike("set_model_tiers", json!({"A": 2})), [b_c]);
        assert_eq!(alike("set_model_tiers", json!({"A": 1})), all);
        assert_eq!(alike("set_usage_quotas", json!({"A": 9, "B": 9, "C": 8})), [a_b]);
        assert_eq!(alike("set_usage_quotas", json!({"A": 9, "B": 9, "C": 9})), all);
        let scope = |plan: &str| json!({"S1": {plan: 3}});
        assert_eq!(alike("set_promotion", json!({"by_group_plan": scope("B")})), [a_c]);
        assert_eq!(alike("set_promotion", json!({"by_group_plan": {}})), all);
        assert_eq!(alike("set_targeted_ops_spend", json!({"by_group_plan": scope("A")})), [b_c]);
        assert_eq!(alike("set_targeted_ops_spend", json!({"by_group_plan": {}, "by_plan": {"C": 4}})), [a_b]);
        assert_eq!(alike("set_targeted_ops_spend", json!({"by_plan": {}})), all);
        assert_eq!(alike("set_promotion", json!({"by_group": {"S1": 3}})), all, "it applies to every plan");
    }
}
