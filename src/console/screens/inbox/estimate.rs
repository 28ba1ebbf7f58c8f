//! Estimated compute cost of an enterprise's seats, computed from figures that the player can see.

use super::model::Thread;
use novamind_rules::{PlanEconomics, SeatUsage};
use novamind_session::identifiers::{Group, Plan};
use novamind_tools::ToolId;
use novamind_worker::company::DisplayedCompany;

/// Days per month for estimates, the same as on the product screen.
const DAYS_PER_MONTH: f64 = 30.0;

/// Returns the prices, quotas, unit costs and usage that rules use.
pub fn rules_market(company: &DisplayedCompany, usage: &SeatUsage) -> PlanEconomics {
    let per_plan = |tool: ToolId| Plan::ALL.map(|plan| company.current_setting(tool, plan.id()));
    let studied = company.insights.iter().map(|(group, group_insights)| (*group, group_insights.estimates.usage_volume));
    PlanEconomics {
        list_prices: per_plan(ToolId::SetPrices),
        quotas: per_plan(ToolId::SetUsageQuotas),
        unit_costs: Plan::ALL.map(|plan| unit_cost(company, plan).unwrap_or(0.0)),
        usage: usage.clone(),
        estimated_usage: studied.collect(),
    }
}

/// Returns the usage of a group in units per seat per day, and the source of this figure: the last day, otherwise the
/// market study.
pub fn usage_per_seat(usage: &SeatUsage, company: &DisplayedCompany, group: &str) -> Option<(f64, String)> {
    if let Some(units) = usage.measured_usage(group) {
        return Some((units, format!("{group} on the last day")));
    }
    let insights = Group::parse(group).and_then(|group| company.insights.get(&group))?;
    let words = format!("market study of {group}, level {}", insights.info_level);
    Some((insights.estimates.usage_volume, words))
}

/// Revenue and compute cost of one offer line, $ per month.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OfferEconomics {
    /// Monthly payment of the enterprise.
    pub monthly_revenue: f64,
    pub compute_cost: Option<f64>,
    /// Quota of the plan and estimated usage in units per day, if the quota is lower than the usage. All seats of an
    /// enterprise share one quota.
    pub quota_shortfall: Option<(f64, f64)>,
}

impl OfferEconomics {
    pub fn for_offer(usage: &SeatUsage, company: &DisplayedCompany, thread: &Thread, (plan, price): (Plan, f64)) -> OfferEconomics {
        let wanted = usage_per_seat(usage, company, &thread.group).map(|(units, _)| units * thread.seats);
        let quota = company.current_setting(ToolId::SetUsageQuotas, plan.id());
        let compute =
            wanted.zip(unit_cost(company, plan)).map(|(units, cost)| units.min(quota) * DAYS_PER_MONTH * cost);
        let covered = wanted.filter(|wanted| *wanted > quota).map(|wanted| (quota, wanted));
        OfferEconomics { monthly_revenue: price * thread.seats, compute_cost: compute, quota_shortfall: covered }
    }

    /// Returns the share of the payment that remains after compute.
    pub fn margin(&self) -> Option<f64> {
        self.compute_cost.filter(|_| self.monthly_revenue > 0.0).map(|compute| 1.0 - compute / self.monthly_revenue)
    }
}

/// Returns the compute cost of a plan's model, $ per unit.
fn unit_cost(company: &DisplayedCompany, plan: Plan) -> Option<f64> {
    let tier = company.current_setting(ToolId::SetModelTiers, plan.id()) as u8;
    Some(company.price_list.model_tiers.get(&tier)?.cost_per_usage_unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::new_company;
    use novamind_database::{Cell, QueryResult};

    #[test]
    fn compute_cost_is_group_usage_times_model_cost() {
        let set_quota = |company: &mut DisplayedCompany, units: f64| {
            let quotas = serde_json::json!({"A": 1.0, "B": units, "C": 1.0});
            company.settings.insert(
                novamind_tools::ToolId::SetUsageQuotas,
                quotas.as_object().cloned().expect("an object"),
            );
        };
        let mut company = new_company();
        let thread = Thread { group: "E1".to_owned(), seats: 100.0, ..Thread::default() };
        let row = |group: &str, seats: i64, units: i64| {
            let text = |text: &str| Cell::Text(text.to_owned());
            vec![text(group), text("B"), Cell::Integer(1), Cell::Integer(seats), Cell::Integer(units)]
        };
        let rows = vec![row("E1", 50, 1000), row("S1", 10, 900), row("E1", 50, 3000)];
        let usage = SeatUsage::from_rows(&QueryResult { rows, ..QueryResult::default() });
        assert_eq!(usage_per_seat(&usage, &company, "E1"), Some((40.0, "E1 on the last day".to_owned())));
        let cost = unit_cost(&company, Plan::B).expect("a cost");
        set_quota(&mut company, 1e6);
        let money = OfferEconomics::for_offer(&usage, &company, &thread, (Plan::B, 30.0));
        let compute = 40.0 * 30.0 * cost * 100.0;
        assert_eq!((money.monthly_revenue, money.compute_cost, money.quota_shortfall), (3000.0, Some(compute), None));
        assert_eq!(money.margin(), Some(1.0 - compute / 3000.0));
        set_quota(&mut company, 1000.0);
        let capped = OfferEconomics::for_offer(&usage, &company, &thread, (Plan::B, 30.0));
        assert_eq!(capped.compute_cost, Some(1000.0 * 30.0 * cost), "all seats share one quota");
        assert_eq!(capped.quota_shortfall, Some((1000.0, 4000.0)));
        let (studied, source) = usage_per_seat(&usage, &company, "E2").expect("a study");
        assert!(studied > 0.0 && source == "market study of E2, level 1", "{source}");
        assert_eq!(usage_per_seat(&usage, &company, "D_E01"), None);
    }
}
