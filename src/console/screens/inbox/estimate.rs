//! What the seats of a company would cost in compute: an estimate from what the player can see.

use std::collections::BTreeMap;

use super::model::Thread;
use crate::console::company::Company;
use crate::session::Rows;
use crate::session::{number_at, text_at};
use crate::tools::ToolId;
use crate::world::identifiers::{Group, Plan};

/// Days of a month of compute, as the screen of the product counts them.
const MONTH: f64 = 30.0;

/// Seats of companies that used the product on the last day, and their units, by group.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Usage(BTreeMap<String, (f64, f64)>);

impl Usage {
    /// Reads them; individuals are left out.
    pub fn read(rows: &Rows) -> Usage {
        let mut groups: BTreeMap<String, (f64, f64)> = BTreeMap::new();
        let of_companies = |row: &&Vec<crate::session::Cell>| {
            Group::parse(text_at(row, 0)).is_some_and(Group::is_enterprise)
        };
        for row in rows.rows.iter().filter(of_companies) {
            let own = groups.entry(text_at(row, 0).to_owned()).or_default();
            *own = (own.0 + number_at(row, 3), own.1 + number_at(row, 4));
        }
        Usage(groups)
    }

    /// Units a day and seat of a group, and where the figure comes from: measured in the group, else its last study.
    pub fn per_seat(&self, company: &Company, group: &str) -> Option<(f64, String)> {
        if let Some((seats, units)) = self.0.get(group).filter(|(seats, _)| *seats > 0.0) {
            return Some((units / seats, format!("{group} on the last day")));
        }
        let insights = Group::parse(group).and_then(|group| company.insights.get(&group))?;
        let words = format!("the study of {group}, level {}", insights.info_level);
        Some((insights.estimates.usage_volume, words))
    }
}

impl Usage {
    /// Units a day that a company would use with all its seats.
    pub fn wanted(&self, company: &Company, thread: &Thread) -> Option<f64> {
        self.per_seat(company, &thread.group).map(|(units, _)| units * thread.seats)
    }
}

/// Money of one line of an offer, dollars a month.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Money {
    /// What the company would pay.
    pub monthly: f64,
    /// What compute would cost.
    pub compute: Option<f64>,
    /// The quota of the plan and what the company would use, units a day, where the quota is less. All seats of a company
    /// share one quota.
    pub covered: Option<(f64, f64)>,
}

impl Money {
    /// Of a plan at a price a seat.
    pub fn of(usage: &Usage, company: &Company, thread: &Thread, (plan, price): (Plan, f64)) -> Money {
        let wanted = usage.wanted(company, thread);
        let quota = company.setting(ToolId::SetUsageQuotas, plan.id());
        let compute =
            wanted.zip(unit_cost(company, plan)).map(|(units, cost)| units.min(quota) * MONTH * cost);
        let covered = wanted.filter(|wanted| *wanted > quota).map(|wanted| (quota, wanted));
        Money { monthly: price * thread.seats, compute, covered }
    }

    /// Share of the payment that compute leaves.
    pub fn margin(&self) -> Option<f64> {
        self.compute.filter(|_| self.monthly > 0.0).map(|compute| 1.0 - compute / self.monthly)
    }
}

/// Dollars a unit with the model of a plan.
fn unit_cost(company: &Company, plan: Plan) -> Option<f64> {
    let tier = company.setting(ToolId::SetModelTiers, plan.id()) as u8;
    Some(company.costs.model_tiers.get(&tier)?.cost_per_usage_unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::test_kit::company;
    use crate::session::Cell;

    #[test]
    fn compute_is_what_the_group_uses_at_the_cost_of_the_model() {
        let set_quota = |company: &mut Company, units: f64| {
            let quotas = serde_json::json!({"A": 1.0, "B": units, "C": 1.0});
            company.settings.insert(
                crate::tools::ToolId::SetUsageQuotas,
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
        let usage = Usage::read(&Rows { rows, ..Rows::default() });
        assert_eq!(usage.per_seat(&company, "E1"), Some((40.0, "E1 on the last day".to_owned())));
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
        let (studied, source) = usage.per_seat(&company, "E2").expect("a study");
        assert!(studied > 0.0 && source == "the study of E2, level 1", "{source}");
        assert_eq!(usage.per_seat(&company, "D_E01"), None);
    }
}
