//! Daily figures of a run, including hidden ones (docs/interfaces/golden.md#figures).

mod market;

use std::collections::{BTreeMap, VecDeque};

use novamind_session::{DayReport, Xray};
use novamind_world::events::{Category, EndCause, Source, SubscriptionEnded, SubscriptionStatus};
use novamind_world::identifiers::{ByGroup, ByPlan, Group, Plan};
use novamind_world::market::economy::Dimension;

/// One value.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Day.
    pub day: u32,
    /// Name.
    pub figure: &'static str,
    /// Breakdown, for example a group; empty for none.
    pub group: &'static str,
    /// Value.
    pub value: f64,
}

/// Aggregation of daily values into a figure.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Value at the end of the day.
    Now,
    /// Sum over all days so far.
    Sum,
    /// Mean over the last 30 days.
    Month,
    /// Sum over all days so far divided by the sum of a weight, for example per deal.
    Mean {
        /// Weight of the day.
        weight: f64,
    },
}

struct Daily {
    figure: &'static str,
    group: &'static str,
    kind: Kind,
    /// `None` if undefined, for example a mean over no customers.
    value: Option<f64>,
}

/// Collects the figures of a run.
#[derive(Default)]
pub struct Collector {
    /// Days whose figures are kept; `None`: all.
    wanted: Option<Vec<u32>>,
    sums: Vec<f64>,
    weights: Vec<f64>,
    windows: Vec<VecDeque<f64>>,
    /// Counts that exist only as sums.
    open_issues: f64,
    /// Cancellations of enterprises by the day on which the subscription ends, which can be in the future.
    endings: BTreeMap<u32, ByGroup<f64>>,
    /// Number of the next thread on the previous day.
    next_thread: u32,
    figures: Vec<Figure>,
    last_day: u32,
    bankrupt: Option<u32>,
    idle: bool,
}

impl Collector {
    /// Creates a collector that collects nothing.
    pub fn idle() -> Collector {
        Collector { idle: true, ..Collector::default() }
    }

    /// Creates a collector for all days or for the given ones.
    pub fn new(wanted: Option<Vec<u32>>) -> Collector {
        Collector { wanted, ..Collector::default() }
    }

    /// Adds a day.
    pub fn day(&mut self, report: &DayReport<'_>) {
        let Some(xray) = report.xray.filter(|_| !self.idle) else { return };
        self.last_day = report.figures.day;
        self.open_issues +=
            xray.facts().issues_opened.len() as f64 - xray.facts().issues_resolved.len() as f64;
        for ending in xray.facts().endings.iter().filter(|ending| company_left(ending)) {
            self.endings.entry(ending.day).or_default()[ending.group] += 1.0;
        }
        let companies_left = self.endings.remove(&self.last_day).unwrap_or_default();
        let next_thread = xray.world().enterprise.next_thread;
        let threads_opened = next_thread - self.next_thread.max(1);
        self.next_thread = next_thread;
        let day = Day { report, xray, open_issues: self.open_issues, companies_left, threads_opened };
        let daily = day.values();
        self.sums.resize(daily.len(), 0.0);
        self.weights.resize(daily.len(), 0.0);
        self.windows.resize(daily.len(), VecDeque::new());
        let keep = self.wanted.as_ref().is_none_or(|days| days.contains(&self.last_day));
        for (at, own) in daily.into_iter().enumerate() {
            let value = match (own.kind, own.value) {
                (Kind::Now, value) => value,
                (Kind::Sum, value) => {
                    self.sums[at] += value.unwrap_or(0.0);
                    Some(self.sums[at])
                }
                (Kind::Mean { weight }, value) => {
                    self.sums[at] += value.unwrap_or(0.0);
                    self.weights[at] += weight;
                    (self.weights[at] > 0.0).then(|| self.sums[at] / self.weights[at])
                }
                (Kind::Month, value) => {
                    let window = &mut self.windows[at];
                    window.extend(value);
                    if window.len() > 30 {
                        window.pop_front();
                    }
                    (!window.is_empty()).then(|| window.iter().sum::<f64>() / window.len() as f64)
                }
            };
            if let Some(value) = value.filter(|_| keep) {
                self.figures.push(Figure { day: self.last_day, figure: own.figure, group: own.group, value });
            }
        }
        if xray.world().finance.is_bankrupt(xray.params()) {
            self.bankrupt = Some(self.last_day);
        }
    }

    /// Returns all figures. After a bankruptcy, the days up to `until` contain only the bankruptcy.
    pub fn finish(mut self, until: u32) -> Vec<Figure> {
        if let Some(bankrupt) = self.bankrupt {
            for day in self.last_day + 1..=until {
                if self.wanted.as_ref().is_none_or(|days| days.contains(&day)) {
                    let figure = |figure, value| Figure { day, figure, group: "", value };
                    self.figures
                        .extend([figure("alive", 0.0), figure("bankruptcy_day", f64::from(bankrupt))]);
                }
            }
        }
        self.figures
    }
}

/// Returns the groups with separate figures.
fn initial() -> impl Iterator<Item = Group> {
    Group::all().filter(|group| group.initially_known())
}

struct Day<'a> {
    report: &'a DayReport<'a>,
    xray: Xray<'a>,
    open_issues: f64,
    /// Returns the enterprises whose subscription ends on the day.
    companies_left: ByGroup<f64>,
    /// Returns the new threads of all kinds since the previous day, including the player's.
    threads_opened: u32,
}

fn company_left(ending: &SubscriptionEnded) -> bool {
    ending.group.is_enterprise() && ending.status == SubscriptionStatus::Cancelled
}

impl Day<'_> {
    /// Returns the values of the day in the order of docs/interfaces/golden.md#figures.
    fn values(&self) -> Vec<Daily> {
        let mut list = Vec::with_capacity(220);
        self.company(&mut list);
        self.leads(&mut list);
        self.retention(&mut list);
        self.money(&mut list);
        self.service(&mut list);
        self.issues(&mut list);
        self.mood(&mut list);
        self.product(&mut list);
        self.market(&mut list);
        self.posts(&mut list);
        self.notices(&mut list);
        self.enterprise(&mut list);
        list
    }

    fn company(&self, list: &mut Vec<Daily>) {
        let figures = self.report.figures;
        let total: u32 = Group::all().map(|group| self.xray.subscribers(group)).sum();
        now(list, "alive", 1.0);
        now(list, "cash", figures.cash);
        now(list, "mrr", figures.mrr);
        now(list, "subs_total", f64::from(total));
        now(list, "individual_subs", f64::from(figures.individual_subscribers));
        now(list, "ent_seats", f64::from(figures.enterprise_seats));
        by_group(list, "subs", Kind::Now, |group| f64::from(self.xray.subscribers(group)));
        for plan in Plan::ALL {
            push(list, "plan_subs", plan.id(), Kind::Now, Some(f64::from(self.xray.on_plan(plan))));
        }
    }

    fn leads(&self, list: &mut Vec<Daily>) {
        let (facts, figures) = (self.xray.facts(), self.report.figures);
        let (mut new_subs, mut lost) = (ByGroup::<f64>::default(), ByGroup::<f64>::default());
        let mut new_on_plan = ByPlan([0.0; 3]);
        let first = facts.arrivals.first().map_or(0, |arrival| arrival.customer);
        for opened in &facts.openings {
            let group = facts.arrivals[(opened.customer - first) as usize].group;
            match (opened.status, opened.plan) {
                (SubscriptionStatus::Subscribed, Some(plan)) => {
                    new_subs[group] += 1.0;
                    new_on_plan[plan] += 1.0;
                }
                (SubscriptionStatus::Lost, _) => lost[group] += 1.0,
                _ => {}
            }
        }
        let mut leads = ByGroup::<f64>::default();
        facts.arrivals.iter().for_each(|arrival| leads[arrival.group] += 1.0);
        by_group(list, "new_subs_cum", Kind::Sum, |group| new_subs[group]);
        for plan in Plan::ALL {
            push(list, "new_subs_plan_cum", plan.id(), Kind::Sum, Some(new_on_plan[plan]));
        }
        by_group(list, "lost_leads_cum", Kind::Sum, |group| lost[group]);
        by_group(list, "leads_cum", Kind::Sum, |group| leads[group]);
        by_group(list, "leads_expected_cum", Kind::Sum, |group| self.xray.lead_factors(group).expected());
        by_group(list, "network_leads_cum", Kind::Sum, |group| self.xray.lead_factors(group).network);
        sum(list, "new_leads_cum", f64::from(figures.new_leads));
        month(list, "new_leads_m30", f64::from(figures.new_leads));
        sum(list, "new_individual_leads_cum", f64::from(figures.new_individual_leads));
        sum(list, "new_enterprise_leads_cum", f64::from(figures.new_enterprise_leads));
        sum(list, "new_individual_subscribers_cum", f64::from(figures.new_individual_subscribers));
        sum(list, "new_ent_seats_cum", f64::from(figures.new_enterprise_seats));
        for source in Source::ALL {
            let came = facts.arrivals.iter().filter(|arrival| arrival.source == source).count();
            push(list, "acq_source_cum", source.id(), Kind::Sum, Some(came as f64));
        }
        for group in initial() {
            push(list, "demand_mult", group.id(), Kind::Now, Some(self.xray.lead_factors(group).saturation));
        }
        for group in initial() {
            let multiplier = self.xray.macro_multiplier(group, Dimension::LeadGeneration);
            push(list, "macro_lead_mult", group.id(), Kind::Now, Some(multiplier));
        }
        let s1 = Group::at(0).expect("S1 exists");
        now(list, "surge_mult", self.xray.lead_factors(s1).surge);
    }

    fn retention(&self, list: &mut Vec<Daily>) {
        let (facts, figures) = (self.xray.facts(), self.report.figures);
        let individuals = || facts.endings.iter().filter(|ending| !ending.group.is_enterprise());
        let count = |group: Group, involuntary: bool| {
            let fits = |cause: EndCause| (cause == EndCause::Involuntary) == involuntary;
            individuals().filter(|ending| ending.group == group && fits(ending.cause)).count() as f64
        };
        sum(list, "cancellations_cum", f64::from(figures.cancellations));
        by_group(list, "cancel_involuntary_cum", Kind::Sum, |group| count(group, true));
        by_group(list, "cancel_quality_or_price_cum", Kind::Sum, |group| count(group, false));
        sum(list, "upgrades_cum", f64::from(figures.upgrades));
        sum(list, "downgrades_cum", f64::from(figures.downgrades));
        let blocks =
            || Group::all().filter(|group| !group.is_enterprise()).flat_map(|group| self.xray.blocks(group));
        let subscribers: usize = blocks().map(|block| block.len()).sum();
        let mean = |total: f64| (subscribers > 0).then(|| total / subscribers as f64);
        let prices = blocks().flat_map(|block| &block.effective_price).sum();
        let rates = blocks().flat_map(|block| &block.usage_rate).sum();
        push(list, "eff_price_mean", "", Kind::Now, mean(prices));
        push(list, "usage_rate_mean", "", Kind::Now, mean(rates));
    }

    fn money(&self, list: &mut Vec<Daily>) {
        let (facts, figures) = (self.xray.facts(), self.report.figures);
        sum(list, "payments_received_cum", figures.payments_received);
        sum(list, "total_costs_cum", figures.total_costs);
        let lead_cost = self.xray.params().leads.lead_acquisition_cost;
        for category in Category::ALL {
            let booked = facts.ledger.iter().chain(self.xray.called());
            let other = booked.filter(|entry| entry.category == category);
            let value = match category {
                Category::LeadAcquisitionCost => -lead_cost * facts.arrivals.len() as f64,
                Category::SubscriptionPayment => figures.payments_received,
                _ => other.map(|entry| entry.amount).sum(),
            };
            push(list, "ledger_cum", category.id(), Kind::Sum, Some(value));
        }
    }

    fn service(&self, list: &mut Vec<Daily>) {
        let figures = self.report.figures;
        let outage = f64::from(u8::from(figures.outage));
        sum(list, "total_usage_cum", figures.total_usage as f64);
        month(list, "total_usage_m30", figures.total_usage as f64);
        sum(list, "overload_cum", figures.overload);
        month(list, "overload_m30", figures.overload);
        sum(list, "overload_day_cum", f64::from(u8::from(figures.overload > 0.0)));
        sum(list, "outage_cum", outage);
        month(list, "outage_m30", outage);
        sum(list, "downtime_minutes_cum", f64::from(figures.downtime_minutes));
        month(list, "p95_ms_m30", figures.p95_ms);
        month(list, "error_rate_m30", figures.error_rate);
        now(list, "capacity_tier", f64::from(self.xray.world().settings.core.capacity_tier));
    }

    fn issues(&self, list: &mut Vec<Daily>) {
        let facts = self.xray.facts();
        sum(list, "issues_created_cum", facts.issues_opened.len() as f64);
        sum(list, "issues_resolved_cum", facts.issues_resolved.len() as f64);
        now(list, "issues_open_all", self.open_issues);
        let open = || {
            let blocks = self.xray.world().customers.blocks();
            blocks.flat_map(|(_, block)| &block.open_issue_days).filter(|days| **days > 0)
        };
        let count = open().count() as f64;
        now(list, "issues_open_active", count);
        let days: f64 = open().map(|days| f64::from(*days)).sum();
        push(list, "issue_age_mean", "", Kind::Now, (count > 0.0).then(|| days / count));
    }

    fn mood(&self, list: &mut Vec<Daily>) {
        for group in initial() {
            push(list, "reputation", group.id(), Kind::Now, Some(self.xray.reputation(group)));
        }
        let moods: Vec<(Group, Option<(f64, f64)>)> =
            initial().map(|group| (group, self.xray.mood(group))).collect();
        for (group, mood) in &moods {
            push(list, "sat_mean", group.id(), Kind::Now, mood.map(|(satisfaction, _)| satisfaction));
        }
        for (group, mood) in &moods {
            push(list, "rel_mean", group.id(), Kind::Now, mood.map(|(_, relationship)| relationship));
        }
    }

    fn product(&self, list: &mut Vec<Daily>) {
        let product = &self.xray.world().product;
        now(list, "q_shared_bonus", product.shared_bonus);
        for group in initial() {
            push(list, "q_group_bonus", group.id(), Kind::Now, Some(product.group_bonus[group]));
        }
        now(list, "bank_shared", product.shared_bank);
        for group in initial() {
            push(list, "bank_group", group.id(), Kind::Now, Some(product.group_bank[group]));
        }
        let drift = &self.xray.world().market.drift;
        now(list, "global_q_bias", drift.global_quality);
        for group in initial() {
            push(list, "drift_q_bias", group.id(), Kind::Now, Some(drift.quality[group]));
        }
        for group in initial() {
            push(list, "drift_c_max", group.id(), Kind::Now, Some(drift.c_max[group]));
        }
    }
}

fn push(list: &mut Vec<Daily>, figure: &'static str, group: &'static str, kind: Kind, value: Option<f64>) {
    list.push(Daily { figure, group, kind, value });
}

fn now(list: &mut Vec<Daily>, figure: &'static str, value: f64) {
    push(list, figure, "", Kind::Now, Some(value));
}

fn sum(list: &mut Vec<Daily>, figure: &'static str, value: f64) {
    push(list, figure, "", Kind::Sum, Some(value));
}

fn month(list: &mut Vec<Daily>, figure: &'static str, value: f64) {
    push(list, figure, "", Kind::Month, Some(value));
}

/// Returns one value per initial group, and sums over the discoverable individual and enterprise groups.
fn by_group(list: &mut Vec<Daily>, figure: &'static str, kind: Kind, value: impl Fn(Group) -> f64) {
    for group in initial() {
        push(list, figure, group.id(), kind, Some(value(group)));
    }
    for (name, enterprise) in [("D_S*", false), ("D_E*", true)] {
        let members =
            Group::all().filter(|group| !group.initially_known() && group.is_enterprise() == enterprise);
        push(list, figure, name, kind, Some(members.map(&value).sum()));
    }
}
