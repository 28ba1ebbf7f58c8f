//! Weekly figures of each customer group.

use std::collections::BTreeMap;

use super::dashboard::delivered_quality;
use novamind_record::figures::GroupFigures;
use novamind_world::canonical::canonical;
use novamind_world::customers::columns::Block;
use novamind_world::events::{Arrival, DayFigures, Facts, SubscriptionStatus};
use novamind_world::identifiers::{ByChannel, ByGroup, ByPlan, Group};
use novamind_world::params::Params;
use novamind_world::state::World;

/// Results of advertising to a group through a channel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PaidLeads {
    /// Leads of the group that arrived through the channel.
    pub leads: u32,
    /// Advertising spending, dollars.
    pub spend: f64,
    /// Number of individual leads that signed up and were billed on the day of their arrival.
    pub billed: u32,
}

canonical! { PaidLeads { leads, spend, billed } }

/// Visible and estimated figures of a group in a week.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GroupWeek {
    /// Leads of the group.
    pub leads: u32,
    /// Leads by word of mouth; all other leads arrived through channels.
    pub word_of_mouth: u32,
    /// Results of advertising to the group, by channel.
    pub paid: ByChannel<PaidLeads>,
    /// Number of enterprise leads that opened a thread. All other enterprise leads found no plan of sufficient quality
    /// at any price.
    pub asked: u32,
    /// Number of individuals who signed up, or of enterprises that accepted a first deal.
    pub signed: u32,
    /// Number of individuals who signed up, by plan.
    pub chosen: ByPlan<u32>,
    /// Cancellations in the week.
    pub left: u32,
    /// Usage in units, by plan.
    pub usage: ByPlan<u64>,
    /// Usage on the last day of the week in units, by plan.
    pub last_usage: ByPlan<u64>,
    /// Individual subscribers at the end of the week, by plan.
    pub subscribers: ByPlan<u32>,
    /// Monthly revenue from individual subscribers at the end of the week, dollars, by plan.
    pub revenue: ByPlan<f64>,
    /// Delivered quality at the end of the week, by plan; `None` while the group is unknown.
    pub quality: Option<ByPlan<f64>>,
    /// Estimated range of the group's mean required quality at the end of the week; `None` while the group is unknown.
    pub floor: Option<(f64, f64)>,
}

canonical! {
    GroupWeek {
        leads, word_of_mouth, paid, asked, signed, chosen, left, usage, last_usage, subscribers, revenue, quality,
        floor,
    }
}

impl GroupWeek {
    /// Returns the number of leads that arrived through channels.
    pub fn paid_leads(&self) -> u32 {
        self.leads - self.word_of_mouth
    }

    /// Returns the monthly revenue per subscriber, in dollars; 0 without subscribers.
    pub fn revenue_per_subscriber(&self) -> f64 {
        let subscribers: u32 = self.subscribers.0.iter().sum();
        self.revenue.0.iter().sum::<f64>() / f64::from(subscribers.max(1))
    }

    /// Returns the share of leads that signed up, or `None` if there were no leads.
    pub fn conversion(&self) -> Option<f64> {
        (self.leads > 0).then(|| f64::from(self.signed) / f64::from(self.leads))
    }
}

/// Adds the figures and facts of a day to the figures of its week.
pub fn add_day_to_week(week: &mut ByGroup<GroupWeek>, figures: &DayFigures, facts: &Facts, world: &World) {
    let arrivals: BTreeMap<u32, &Arrival> =
        facts.arrivals.iter().map(|arrival| (arrival.customer, arrival)).collect();
    for arrival in arrivals.values() {
        let group_week = &mut week[arrival.group];
        group_week.leads += 1;
        group_week.word_of_mouth += u32::from(arrival.source.channel().is_none());
    }
    for pair in &facts.channel_leads {
        let paid = &mut week[pair.group].paid[pair.channel];
        paid.leads += pair.leads;
        paid.spend += pair.spend;
    }
    for opening in &facts.openings {
        let Some(arrival) = arrivals.get(&opening.customer) else { continue };
        let group_week = &mut week[arrival.group];
        match opening.status {
            SubscriptionStatus::Lead => group_week.asked += 1,
            SubscriptionStatus::Subscribed => {
                group_week.signed += 1;
                if let Some(channel) = arrival.source.channel() {
                    group_week.paid[channel].billed += 1;
                }
                if let Some(plan) = opening.plan {
                    group_week.chosen[plan] += 1;
                }
            }
            SubscriptionStatus::Cancelled | SubscriptionStatus::Lost => {}
        }
    }
    for deal in facts.deals.iter().filter(|deal| deal.activated) {
        if let Some(company) = world.enterprise.enterprise_customer(deal.customer) {
            week[company.group].signed += 1;
        }
    }
    for ending in facts.endings.iter().filter(|ending| ending.status == SubscriptionStatus::Cancelled) {
        week[ending.group].left += 1;
    }
    for group in Group::all() {
        let group_week = &mut week[group];
        group_week.last_usage = figures.usage[group];
        for (sum, units) in group_week.usage.0.iter_mut().zip(group_week.last_usage.0) {
            *sum += units;
        }
    }
}

/// Completes the figures of all groups at the end of a week. `floor` returns the estimated range of a group's mean
/// required quality, if the group is known.
pub(crate) fn finish_week(
    week: &mut ByGroup<GroupWeek>,
    world: &World,
    params: &Params,
    floor: impl Fn(Group) -> Option<(f64, f64)>,
) {
    for quality in delivered_quality(world, params) {
        week[quality.group].quality = Some(quality.by_plan);
        week[quality.group].floor = floor(quality.group);
    }
    for (group, block) in world.customers.blocks().filter(|(group, _)| !group.is_enterprise()) {
        for (plan, price) in block.plan.iter().zip(&block.effective_price) {
            week[group].subscribers[*plan] += 1;
            week[group].revenue[*plan] += price;
        }
    }
}

/// The subscriptions of a plan that could use the product on the last day, and their revenue.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlanRevenue {
    /// Number of subscriptions.
    pub subscriptions: u32,
    /// Number of whole seats of the subscriptions.
    pub seats: f64,
    /// Revenue of the subscriptions, dollars per month.
    pub monthly: f64,
}

/// Returns the revenue of the subscriptions of each plan that started before the last day. Subscriptions that started
/// on the last day have no usage yet.
pub(crate) fn plan_revenue(world: &World) -> ByPlan<PlanRevenue> {
    let mut revenue = ByPlan::<PlanRevenue>::default();
    for (_, block) in world.customers.blocks() {
        for at in (0..block.len()).filter(|at| block.start_day[*at] < world.day) {
            let (sum, seats) = (&mut revenue[block.plan[at]], block.seats[at].trunc());
            sum.subscriptions += 1;
            sum.seats += seats;
            sum.monthly += block.effective_price[at] * seats;
        }
    }
    revenue
}

/// Returns the mean satisfaction and the mean relationship of a group's active subscribers, or `None` if the group has
/// no active subscribers.
pub fn mean_satisfaction(world: &World, group: Group) -> Option<(f64, f64)> {
    let blocks = || world.customers.groups[group].blocks.iter();
    let count: usize = blocks().map(Block::len).sum();
    let satisfaction: f64 = blocks().flat_map(|block| &block.satisfaction).sum();
    let relationship: f64 = blocks().flat_map(|block| &block.relationship).sum();
    (count > 0).then(|| (satisfaction / count as f64, relationship / count as f64))
}

/// Returns the figures of a group, including hidden figures. `counted` contains the sums over the days of the period.
pub fn measure_group(group: Group, counted: &GroupWeek, world: &World) -> GroupFigures {
    let (satisfaction, relationship) = mean_satisfaction(world, group).unzip();
    let group_customers = &world.customers.groups[group];
    GroupFigures {
        leads: counted.leads,
        signed: counted.signed,
        left: counted.left,
        usage: counted.usage.0.iter().sum(),
        subscribers: group_customers.active_count(),
        open_issues: group_customers.blocks.iter().map(Block::open_issues).sum(),
        reputation: world.market.reputation.get(group),
        satisfaction,
        relationship,
    }
}
