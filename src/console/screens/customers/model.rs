//! Customer figures that are collected from query results.

use std::collections::BTreeMap;

use serde_json::Value;

use novamind_database::{QueryResult, number_at, text_at};
use novamind_session::identifiers::{Channel, Group, Plan};
use novamind_tools::ToolId;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::screen_queries::Reading;

pub const CURVE_WEEKS: u32 = 12;

/// Subscribers of one group on one plan.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PlanSubscribers {
    pub customers: f64,
    pub seats: f64,
    /// Revenue in dollars per month.
    pub monthly_revenue: f64,
    /// Units used on the last day.
    pub units: f64,
    /// Seats whose usage is counted in `units`.
    pub users: f64,
    /// Subscriptions that were active 30 days ago.
    pub active_30_days_ago: f64,
}

/// Customer changes of a group in one week.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WeekFlow {
    pub leads: f64,
    pub signups: f64,
    pub cancellations: f64,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct GroupFacts {
    pub plans: [PlanSubscribers; 3],
    pub weeks: BTreeMap<u32, WeekFlow>,
    /// Leads and signups of the last weeks by acquisition source.
    pub sources: BTreeMap<String, (f64, f64)>,
    /// Number of subscriptions that were active 30 days ago and have ended since.
    pub lost_in_30_days: f64,
}

impl GroupFacts {
    pub fn sum(&self, figure: impl Fn(&PlanSubscribers) -> f64) -> f64 {
        self.plans.iter().map(figure).sum()
    }

    pub fn week(&self, week: u32) -> WeekFlow {
        self.weeks.get(&week).copied().unwrap_or_default()
    }

    /// Returns the sum of a figure over the last `count` weeks.
    pub fn sum_of_last_weeks(&self, week: u32, count: u32, figure: impl Fn(&WeekFlow) -> f64) -> f64 {
        let from = (week + 1).saturating_sub(count);
        self.weeks.range(from..=week.max(from)).map(|(_, flow)| figure(flow)).sum()
    }

    /// Returns the values of a figure in the last weeks, the oldest first. Weeks before the start are omitted.
    pub fn weekly_values(&self, week: u32, figure: impl Fn(&WeekFlow) -> f64) -> Vec<(u32, f64)> {
        let from = (week + 1).saturating_sub(CURVE_WEEKS).max(1);
        (from..=week).map(|week| (week, figure(&self.week(week)))).collect()
    }

    /// Returns the subscriptions at the end of each recent week, computed backwards from the current number.
    pub fn subscriptions_by_week(&self, week: u32) -> Vec<(u32, f64)> {
        let mut stock = self.sum(|plan_subscribers| plan_subscribers.customers);
        let mut all = Vec::new();
        for (week, _) in self.weekly_values(week, |_| 0.0).into_iter().rev() {
            all.push((week, stock));
            let flow = self.week(week);
            stock = (stock - flow.signups + flow.cancellations).max(0.0);
        }
        all.reverse();
        all
    }

    /// Returns the 30-day churn as a share.
    pub fn churn(&self) -> Option<f64> {
        let before = self.sum(|plan_subscribers| plan_subscribers.active_30_days_ago) + self.lost_in_30_days;
        (before > 0.0).then(|| self.lost_in_30_days / before)
    }

    /// Returns the revenue in dollars per seat per month.
    pub fn revenue_per_seat(&self) -> Option<f64> {
        let seats = self.sum(|plan_subscribers| plan_subscribers.seats);
        (seats > 0.0).then(|| self.sum(|subscribers| subscribers.monthly_revenue) / seats)
    }

    /// Returns the usage on the last day in units per seat.
    pub fn usage(&self) -> Option<f64> {
        let users = self.sum(|plan_subscribers| plan_subscribers.users);
        (users > 0.0).then(|| self.sum(|subscribers| subscribers.units) / users)
    }
}

/// Leads and advertising spending of a channel in a group.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ChannelMeasurement {
    pub leads: f64,
    pub spend: f64,
}

impl ChannelMeasurement {
    /// Returns the leads per $1,000, or `None` if no money was spent.
    pub fn leads_per_thousand(&self) -> Option<f64> {
        (self.spend > 0.0).then(|| self.leads / self.spend * 1000.0)
    }
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct CustomerData {
    groups: BTreeMap<Group, GroupFacts>,
    channels: BTreeMap<(usize, Group), ChannelMeasurement>,
}

impl CustomerData {
    pub fn facts_of_group(&self, group: Group) -> GroupFacts {
        self.groups.get(&group).cloned().unwrap_or_default()
    }

    /// Returns the leads and spending of a channel in a group over the last four weeks.
    pub fn channel_measurement(&self, channel: Channel, group: Group) -> ChannelMeasurement {
        self.channels.get(&(channel.index(), group)).copied().unwrap_or_default()
    }

    /// Returns the advertising spending for a group in the last four weeks, in dollars.
    pub fn ad_spend(&self, group: Group) -> f64 {
        Channel::ALL.iter().map(|channel| self.channel_measurement(*channel, group).spend).sum()
    }

    pub fn apply_rows(&mut self, reading: Reading, rows: &QueryResult) {
        self.clear_query_figures(reading);
        for row in &rows.rows {
            match reading {
                Reading::Subscribers => self.update_plan(row, |plan_subscribers, row| {
                    plan_subscribers.customers = number_at(row, 2);
                    plan_subscribers.seats = number_at(row, 3);
                    plan_subscribers.monthly_revenue = number_at(row, 4);
                    plan_subscribers.active_30_days_ago = number_at(row, 5);
                }),
                Reading::Usage => self.update_plan(row, |subscribers, row| {
                    subscribers.users = number_at(row, 2);
                    subscribers.units = number_at(row, 4);
                }),
                Reading::Arrivals => self.add_leads(row),
                Reading::Departures => {
                    let Some(group) = Group::parse(text_at(row, 1)) else { continue };
                    let facts = self.groups.entry(group).or_default();
                    let flow = facts.weeks.entry(number_at(row, 0) as u32).or_default();
                    flow.cancellations += number_at(row, 2);
                    facts.lost_in_30_days += number_at(row, 3);
                }
                Reading::LeadsByChannel => {
                    let (channel, group) = (Channel::parse(text_at(row, 0)), Group::parse(text_at(row, 1)));
                    if let (Some(channel), Some(group)) = (channel, group) {
                        let measured = ChannelMeasurement { leads: number_at(row, 2), spend: number_at(row, 3) };
                        self.channels.insert((channel.index(), group), measured);
                    }
                }
                _ => {}
            }
        }
    }

    fn clear_query_figures(&mut self, reading: Reading) {
        if reading == Reading::LeadsByChannel {
            self.channels.clear();
        }
        for facts in self.groups.values_mut() {
            match reading {
                Reading::Subscribers => facts.plans.iter_mut().for_each(|plan_subscribers| {
                    *plan_subscribers = PlanSubscribers { users: plan_subscribers.users, units: plan_subscribers.units, ..PlanSubscribers::default() };
                }),
                Reading::Usage => facts.plans.iter_mut().for_each(|subscribers| {
                    *subscribers = PlanSubscribers { users: 0.0, units: 0.0, ..*subscribers };
                }),
                Reading::Arrivals => {
                    facts.sources.clear();
                    let flows = facts.weeks.values_mut();
                    flows.for_each(|flow| *flow = WeekFlow { cancellations: flow.cancellations, ..WeekFlow::default() });
                }
                Reading::Departures => {
                    facts.lost_in_30_days = 0.0;
                    facts.weeks.values_mut().for_each(|flow| flow.cancellations = 0.0);
                }
                _ => {}
            }
        }
    }

    fn update_plan(
        &mut self,
        row: &[novamind_database::Cell],
        take: impl Fn(&mut PlanSubscribers, &[novamind_database::Cell]),
    ) {
        let (group, plan) = (Group::parse(text_at(row, 0)), Plan::parse(text_at(row, 1)));
        if let (Some(group), Some(plan)) = (group, plan) {
            let facts = self.groups.entry(group).or_default();
            take(&mut facts.plans[Plan::ALL.iter().position(|other_plan| *other_plan == plan).unwrap_or(0)], row);
        }
    }

    fn add_leads(&mut self, row: &[novamind_database::Cell]) {
        let Some(group) = Group::parse(text_at(row, 1)) else { return };
        let (leads, signed) = (number_at(row, 3), number_at(row, 4));
        let facts = self.groups.entry(group).or_default();
        let flow = facts.weeks.entry(number_at(row, 0) as u32).or_default();
        flow.leads += leads;
        flow.signups += signed;
        let source = facts.sources.entry(text_at(row, 2).to_owned()).or_default();
        *source = (source.0 + leads, source.1 + signed);
    }
}

/// Returns the advertising budget of a group in a channel, $ per day.
pub fn ad_budget(company: &DisplayedCompany, channel: Channel, group: Group) -> f64 {
    let spend = company.settings.get(&ToolId::SetTargetedAdSpend).and_then(|all| all.get("targeted_spend"));
    let value = spend.and_then(|all| all.get(channel.id())).and_then(|groups| groups.get(group.id()));
    value.and_then(Value::as_f64).unwrap_or(0.0)
}

/// Returns the advertising budget of a group in all channels, $ per day.
pub fn total_ad_budget(company: &DisplayedCompany, group: Group) -> f64 {
    Channel::ALL.iter().map(|channel| ad_budget(company, *channel, group)).sum()
}

/// Returns the development budget of a group, $ per day.
pub fn development_budget(company: &DisplayedCompany, group: Group) -> f64 {
    let spend = company.settings.get(&ToolId::SetTargetedDevSpend).and_then(|all| all.get("targeted_spend"));
    spend.and_then(|all| all.get(group.id())).and_then(Value::as_f64).unwrap_or(0.0)
}
