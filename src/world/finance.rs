//! Costs of a day, the ledger, and bankruptcy (`docs/mechanics/money.md`).

use super::canonical::canonical;
use super::events::{Category, Facts, LedgerEntry, LedgerNote};
use super::fault::Fault;
use super::identifiers::{ByPlan, Plan};
use super::morning::Morning;
use super::params::Params;
use super::product::usage::MeteredUsage;
use super::settings::Settings;

/// The cash of the company, which is the sum of the ledger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finance {
    /// Current cash in dollars, which can be negative within a day.
    pub cash: f64,
}

canonical! { Finance { cash } }

impl Finance {
    /// Adds an entry to the ledger and its amount to cash.
    pub fn book(&mut self, entry: LedgerEntry, facts: &mut Facts) {
        self.cash += entry.amount;
        facts.ledger.push(entry);
    }

    /// Returns whether the company is bankrupt: cash is strictly below the threshold at the end of a day.
    pub fn is_bankrupt(&self, params: &Params) -> bool {
        self.cash < params.run.bankruptcy_cash_threshold
    }
}

/// Returns today's cost of compute in dollars: the units used on each plan times the unit cost of the plan's model.
pub fn compute_cost(metered: &MeteredUsage, morning: &Morning, params: &Params) -> f64 {
    let tiers = match params.has_fault(Fault::ComputeOfOnePlan) {
        true => ByPlan([morning.core.tiers[Plan::A]; Plan::ALL.len()]),
        false => morning.core.tiers,
    };
    let cost = |plan| metered.by_plan[plan] as f64 * params.model_tier(tiers[plan]).unit_cost;
    Plan::ALL.into_iter().map(cost).sum()
}

/// Books the running costs of a day and returns their sum, in dollars. General costs are booked even if they are zero;
/// targeted costs are booked only if they are not zero.
pub fn pay_running_costs(
    finance: &mut Finance,
    metered: &MeteredUsage,
    morning: &Morning,
    settings: &Settings,
    params: &Params,
    facts: &mut Facts,
) -> f64 {
    let capacity = f64::from(params.capacity_tier(settings.core.capacity_tier).cost_per_day);
    let general = [
        (Category::Capacity, capacity),
        (Category::Compute, compute_cost(metered, morning, params)),
        (Category::Operations, settings.core.operations),
        (Category::Development, settings.core.development),
    ];
    let targeted = [
        (Category::Advertising, settings.targeted_ads.total()),
        (Category::Operations, settings.targeted_operations.total()),
        (Category::Development, settings.targeted_development.total()),
    ];
    let mut total = 0.0;
    let mut book = |category, cost: f64, note| {
        total += cost;
        finance.book(LedgerEntry { category, amount: -cost, note }, facts);
    };
    general.into_iter().for_each(|(category, cost)| book(category, cost, LedgerNote::General));
    targeted
        .into_iter()
        .filter(|(_, cost)| *cost > 0.0)
        .for_each(|(category, cost)| book(category, cost, LedgerNote::Targeted));
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identifiers::{Channel, Group};
    use crate::morning::tests::morning;

    #[test]
    fn running_costs_are_booked_in_order() {
        let params = Params::bundled();
        let s1 = Group::at(0).expect("S1");
        let mut settings = Settings::initial(&params);
        settings.core.tiers = ByPlan([2, 4, 1]);
        settings.core.capacity_tier = 1;
        settings.core.operations = 120.0;
        settings.core.development = 300.0;
        settings.targeted_ads.targeted_spend.insert(Channel::SearchAds, [(s1, 175.0)].into_iter().collect());
        settings.targeted_operations.by_group.insert(s1, 17.0);
        settings.targeted_development.targeted_spend.insert(s1, 33.0);
        let mut day = morning(8);
        day.core = settings.core;
        let metered =
            MeteredUsage { total: 189, by_plan: ByPlan([60 + 44, 83 + 2, 0]), ..MeteredUsage::default() };
        assert!((compute_cost(&metered, &day, &params) - 1.228).abs() < 1e-12);
        let (mut finance, mut facts) = (Finance { cash: 1000.0 }, Facts::default());
        let total = pay_running_costs(&mut finance, &metered, &day, &settings, &params, &mut facts);
        assert!((total - 861.228).abs() < 1e-9, "{total}");
        assert!((finance.cash - 138.772).abs() < 1e-9);
        let categories: Vec<&str> = facts.ledger.iter().map(|entry| entry.category.id()).collect();
        let expected =
            ["capacity", "compute", "operations", "development", "advertising", "operations", "development"];
        assert_eq!(categories, expected);
    }

    #[test]
    fn zero_cash_is_not_bankrupt() {
        let params = Params::bundled();
        assert!(!Finance { cash: 0.0 }.is_bankrupt(&params));
        assert!(Finance { cash: -1e-9 }.is_bankrupt(&params));
    }
}
