//! What a week brought of each customer group.

use std::collections::BTreeMap;

use crate::world::canonical::canonical;
use crate::world::events::{DayFigures, Facts, SubscriptionStatus};
use crate::world::identifiers::{ByGroup, ByPlan, Group};
use crate::world::state::World;

/// Figures of a group in a week.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GroupWeek {
    /// Customers who came.
    pub leads: u32,
    /// Companies among them that opened a thread; the others found no plan good enough at any price.
    pub asked: u32,
    /// Individuals who signed up, or companies whose first deal was accepted.
    pub signed: u32,
    /// Individuals who signed up, by the plan they chose.
    pub chosen: ByPlan<u32>,
    /// Subscribers who cancelled.
    pub left: u32,
    /// Units used, by the plan they were used on.
    pub usage: ByPlan<u64>,
    /// Units used on its last day, by the plan they were used on.
    pub last_usage: ByPlan<u64>,
    /// Individual subscribers at its end.
    pub subscribers: ByPlan<u32>,
    /// What they pay at its end, dollars a month.
    pub revenue: ByPlan<f64>,
}

canonical! { GroupWeek { leads, asked, signed, chosen, left, usage, last_usage, subscribers, revenue } }

impl GroupWeek {
    /// Of the leads, those who signed; none without leads.
    pub fn conversion(&self) -> Option<f64> {
        (self.leads > 0).then(|| f64::from(self.signed) / f64::from(self.leads))
    }
}

/// Adds a day to the figures of its week.
pub(in crate::session) fn count(
    week: &mut ByGroup<GroupWeek>,
    figures: &DayFigures,
    facts: &Facts,
    world: &World,
) {
    let came: BTreeMap<u32, Group> =
        facts.arrivals.iter().map(|arrival| (arrival.customer, arrival.group)).collect();
    for group in came.values() {
        week[*group].leads += 1;
    }
    for opening in &facts.openings {
        let Some(group) = came.get(&opening.customer) else { continue };
        let own = &mut week[*group];
        match opening.status {
            SubscriptionStatus::Lead => own.asked += 1,
            SubscriptionStatus::Subscribed => {
                own.signed += 1;
                if let Some(plan) = opening.plan {
                    own.chosen[plan] += 1;
                }
            }
            SubscriptionStatus::Cancelled | SubscriptionStatus::Lost => {}
        }
    }
    for deal in facts.deals.iter().filter(|deal| deal.activated) {
        if let Some(company) = world.enterprise.company(deal.customer) {
            week[company.group].signed += 1;
        }
    }
    for ending in facts.endings.iter().filter(|ending| ending.status == SubscriptionStatus::Cancelled) {
        week[ending.group].left += 1;
    }
    for group in Group::all() {
        let own = &mut week[group];
        own.last_usage = figures.usage[group];
        for (sum, units) in own.usage.0.iter_mut().zip(own.last_usage.0) {
            *sum += units;
        }
    }
}

/// Settles what is counted at the end of a week.
pub(in crate::session) fn settle(week: &mut ByGroup<GroupWeek>, world: &World) {
    for (group, block) in world.customers.blocks().filter(|(group, _)| !group.is_enterprise()) {
        for (plan, price) in block.plan.iter().zip(&block.effective_price) {
            week[group].subscribers[*plan] += 1;
            week[group].revenue[*plan] += price;
        }
    }
}
