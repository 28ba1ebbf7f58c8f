//! Estimated compute cost of an enterprise's seats, from figures that the player can see.

use super::model::Thread;
use novamind_rules::{Market, SeatUsage};
use novamind_session::identifiers::{Group, Plan};
use novamind_tools::ToolId;
use novamind_worker::company::Company;

/// Days per month, as on the product screen.
const MONTH: f64 = 30.0;

/// Returns the sales figures for the rules.
pub fn market_of(company: &Company, usage: &SeatUsage) -> Market {
    let per_plan = |tool: ToolId| Plan::ALL.map(|plan| company.setting(tool, plan.id()));
    let studied = company.insights.iter().map(|(group, told)| (*group, told.estimates.usage_volume));
    Market {
        lists: per_plan(ToolId::SetPrices),
        quotas: per_plan(ToolId::SetUsageQuotas),
        unit_costs: Plan::ALL.map(|plan| unit_cost(company, plan).unwrap_or(0.0)),
        usage: usage.clone(),
        studied: studied.collect(),
    }
}

/// Returns the units per day and seat of a group, with the source: usage on the last day, otherwise the
/// market study.
pub fn per_seat(usage: &SeatUsage, company: &Company, group: &str) -> Option<(f64, String)> {
    if let Some(units) = usage.measured(group) {
        return Some((units, format!("{group} on the last day")));
    }
    let insights = Group::parse(group).and_then(|group| company.insights.get(&group))?;
    let words = format!("market study of {group}, level {}", insights.info_level);
    Some((insights.estimates.usage_volume, words))
}

/// Money of one line of an offer, $ per month.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Money {
    /// Payment of the enterprise.
    pub monthly: f64,
    pub compute: Option<f64>,
    /// Quota of the plan and estimated usage, units per day, if the quota is lower. All seats of an
    /// enterprise share one quota.
    pub covered: Option<(f64, f64)>,
}

impl Money {
    pub fn of(usage: &SeatUsage, company: &Company, thread: &Thread, (plan, price): (Plan, f64)) -> Money {
        let wanted = per_seat(usage, company, &thread.group).map(|(units, _)| units * thread.seats);
        let quota = company.setting(ToolId::SetUsageQuotas, plan.id());
        let compute =
            wanted.zip(unit_cost(company, plan)).map(|(units, cost)| units.min(quota) * MONTH * cost);
        let covered = wanted.filter(|wanted| *wanted > quota).map(|wanted| (quota, wanted));
        Money { monthly: price * thread.seats, compute, covered }
    }

    /// Returns the share of the payment that remains after compute.
    pub fn margin(&self) -> Option<f64> {
        self.compute.filter(|_| self.monthly > 0.0).map(|compute| 1.0 - compute / self.monthly)
    }
}

/// Returns the compute cost of a plan's model, $ per unit.
fn unit_cost(company: &Company, plan: Plan) -> Option<f64> {
    let tier = company.setting(ToolId::SetModelTiers, plan.id()) as u8;
    Some(company.costs.model_tiers.get(&tier)?.cost_per_usage_unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::company;
    use novamind_database::{Cell, Rows};

    #[test]
    fn compute_is_what_the_group_uses_at_the_cost_of_the_model() {
        let set_quota = |company: &mut Company, units: f64| {
            let quotas = serde_json::json!({"A": 1.0, "B": units, "C": 1.0});
            company.settings.insert(
                novamind_tools::ToolId::SetUsageQuotas,
                quotas.as_object().cloned().expect("an object"),
            );
        };
        let mut company = company();
        let thread = Thread { group: "E1".to_owned(), seats: 100.0, ..Thread::default() };
        let row = |group: &str, seats: i64, units: i64| {
            let text = |text: &str| Cell::Text(text.to_owned());
            vec![text(group), text("B"), Cell::Integer(1), Cell::Integer(seats), Cell::Integer(units)]
        };
        let rows = vec![row("E1", 50, 1000), row("S1", 10, 900), row("E1", 50, 3000)];
        let usage = SeatUsage::read(&Rows { rows, ..Rows::default() });
        assert_eq!(per_seat(&usage, &company, "E1"), Some((40.0, "E1 on the last day".to_owned())));
        let cost = unit_cost(&company, Plan::B).expect("a cost");
        set_quota(&mut company, 1e6);
        let money = Money::of(&usage, &company, &thread, (Plan::B, 30.0));
        let compute = 40.0 * 30.0 * cost * 100.0;
        assert_eq!((money.monthly, money.compute, money.covered), (3000.0, Some(compute), None));
        assert_eq!(money.margin(), Some(1.0 - compute / 3000.0));
        set_quota(&mut company, 1000.0);
        let capped = Money::of(&usage, &company, &thread, (Plan::B, 30.0));
        assert_eq!(capped.compute, Some(1000.0 * 30.0 * cost), "all seats share one quota");
        assert_eq!(capped.covered, Some((1000.0, 4000.0)));
        let (studied, source) = per_seat(&usage, &company, "E2").expect("a study");
        assert!(studied > 0.0 && source == "market study of E2, level 1", "{source}");
        assert_eq!(per_seat(&usage, &company, "D_E01"), None);
    }
}
