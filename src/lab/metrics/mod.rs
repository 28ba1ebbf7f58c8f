//! Daily figures of a run, including hidden figures (docs/interfaces/golden.md#figures).

mod market;

use std::collections::{BTreeMap, VecDeque};

use novamind_session::{DayReport, HiddenState};
use novamind_world::events::{Category, EndCause, Source, SubscriptionEnded, SubscriptionStatus};
use novamind_world::identifiers::{ByGroup, ByPlan, Group, Plan};
use novamind_world::market::economy::Dimension;

/// A value of a figure on a day.
#[derive(Debug, Clone, PartialEq)]
pub struct MetricValue {
    /// Day of the value.
    pub day: u32,
    /// Name of the figure, as listed in docs/interfaces/golden.md#figures.
    pub figure: &'static str,
    /// Breakdown of the figure, for example a group; empty for a total.
    pub group: &'static str,
    /// Value of the figure on the day.
    pub value: f64,
}

/// The aggregation of daily values into a figure.
#[derive(Clone, Copy, PartialEq)]
enum Aggregation {
    /// The value of the day itself.
    Latest,
    /// Sum over all days up to the current day.
    Sum,
    /// Mean over the 30 days up to the current day.
    Last30Days,
    /// Weighted mean over all days up to the current day, for example per deal.
    Mean {
        /// Weight of the day's value.
        weight: f64,
    },
}

struct DailyValue {
    figure: &'static str,
    group: &'static str,
    kind: Aggregation,
    /// Value of the day; `None` if the value is undefined, for example a mean over no customers.
    value: Option<f64>,
}

/// A collector of the daily figures of a run.
#[derive(Default)]
pub struct MetricsCollector {
    /// Days whose figures are kept; `None` to keep all days.
    recorded_days: Option<Vec<u32>>,
    sums: Vec<f64>,
    weights: Vec<f64>,
    windows: Vec<VecDeque<f64>>,
    /// Running total of open issues.
    open_issues: f64,
    /// Number of cancelled enterprises, by the day on which their subscription ends. This day can be in the
    /// future.
    lost_enterprises: BTreeMap<u32, ByGroup<f64>>,
    /// Number that the next thread had at the end of the previous day.
    next_thread: u32,
    figures: Vec<MetricValue>,
    last_day: u32,
    bankrupt: Option<u32>,
    is_disabled: bool,
}

impl MetricsCollector {
    /// Creates a collector that collects nothing.
    pub fn disabled() -> MetricsCollector {
        MetricsCollector { is_disabled: true, ..MetricsCollector::default() }
    }

    /// Creates a collector for the days in `wanted`, or for all days if `wanted` is `None`.
    pub fn new(wanted: Option<Vec<u32>>) -> MetricsCollector {
        MetricsCollector { recorded_days: wanted, ..MetricsCollector::default() }
    }

    /// Adds the figures of a day.
    pub fn add_day(&mut self, report: &DayReport<'_>) {
        let Some(xray) = report.xray.filter(|_| !self.is_disabled) else { return };
        self.last_day = report.figures.day;
        self.open_issues +=
            xray.facts().issues_opened.len() as f64 - xray.facts().issues_resolved.len() as f64;
        for ending in xray.facts().endings.iter().filter(|ending| is_lost_enterprise(ending)) {
            self.lost_enterprises.entry(ending.day).or_default()[ending.group] += 1.0;
        }
        let companies_left = self.lost_enterprises.remove(&self.last_day).unwrap_or_default();
        let next_thread = xray.world().enterprise.next_thread;
        let threads_opened = next_thread - self.next_thread.max(1);
        self.next_thread = next_thread;
        let day = MetricsDay { report, xray, open_issues: self.open_issues, companies_left, threads_opened };
        let daily = day.values();
        self.sums.resize(daily.len(), 0.0);
        self.weights.resize(daily.len(), 0.0);
        self.windows.resize(daily.len(), VecDeque::new());
        let keep = self.recorded_days.as_ref().is_none_or(|days| days.contains(&self.last_day));
        for (at, daily_value) in daily.into_iter().enumerate() {
            let value = match (daily_value.kind, daily_value.value) {
                (Aggregation::Latest, value) => value,
                (Aggregation::Sum, value) => {
                    self.sums[at] += value.unwrap_or(0.0);
                    Some(self.sums[at])
                }
                (Aggregation::Mean { weight }, value) => {
                    self.sums[at] += value.unwrap_or(0.0);
                    self.weights[at] += weight;
                    (self.weights[at] > 0.0).then(|| self.sums[at] / self.weights[at])
                }
                (Aggregation::Last30Days, value) => {
                    let window = &mut self.windows[at];
                    window.extend(value);
                    if window.len() > 30 {
                        window.pop_front();
                    }
                    (!window.is_empty()).then(|| window.iter().sum::<f64>() / window.len() as f64)
                }
            };
            if let Some(value) = value.filter(|_| keep) {
                self.figures.push(MetricValue {
                    day: self.last_day,
                    figure: daily_value.figure,
                    group: daily_value.group,
                    value,
                });
            }
        }
        if xray.world().finance.is_bankrupt(xray.params()) {
            self.bankrupt = Some(self.last_day);
        }
    }

    /// Returns all collected figures. After a bankruptcy, the days up to `until` contain only the figures `alive` and
    /// `bankruptcy_day`.
    pub fn finish(mut self, until: u32) -> Vec<MetricValue> {
        if let Some(bankrupt) = self.bankrupt {
            for day in self.last_day + 1..=until {
                if self.recorded_days.as_ref().is_none_or(|days| days.contains(&day)) {
                    let figure = |figure, value| MetricValue { day, figure, group: "", value };
                    self.figures
                        .extend([figure("alive", 0.0), figure("bankruptcy_day", f64::from(bankrupt))]);
                }
            }
        }
        self.figures
    }
}

/// Returns the initially known groups, which have separate figures.
fn initial_groups() -> impl Iterator<Item = Group> {
    Group::all().filter(|group| group.is_initially_known())
}

struct MetricsDay<'a> {
    report: &'a DayReport<'a>,
    xray: HiddenState<'a>,
    open_issues: f64,
    /// Number of enterprises whose subscription ends on the day, by group.
    companies_left: ByGroup<f64>,
    /// Number of threads that were opened since the previous day, including threads that the player started.
    threads_opened: u32,
}

fn is_lost_enterprise(ending: &SubscriptionEnded) -> bool {
    ending.group.is_enterprise() && ending.status == SubscriptionStatus::Cancelled
}

impl MetricsDay<'_> {
    /// Returns the values of the day, in the order of docs/interfaces/golden.md#figures.
    fn values(&self) -> Vec<DailyValue> {
        let mut list = Vec::with_capacity(220);
        self.push_company(&mut list);
        self.push_leads(&mut list);
        self.push_retention(&mut list);
        self.push_money(&mut list);
        self.push_service(&mut list);
        self.push_issues(&mut list);
        self.push_satisfaction(&mut list);
        self.push_product(&mut list);
        self.push_market(&mut list);
        self.push_posts(&mut list);
        self.push_notifications(&mut list);
        self.push_enterprise(&mut list);
        list
    }

    fn push_company(&self, list: &mut Vec<DailyValue>) {
        let figures = self.report.figures;
        let total: u32 = Group::all().map(|group| self.xray.subscribers(group)).sum();
        push_latest(list, "alive", 1.0);
        push_latest(list, "cash", figures.cash);
        push_latest(list, "mrr", figures.mrr);
        push_latest(list, "subs_total", f64::from(total));
        push_latest(list, "individual_subs", f64::from(figures.individual_subscribers));
        push_latest(list, "ent_seats", f64::from(figures.enterprise_seats));
        push_by_group(list, "subs", Aggregation::Latest, |group| f64::from(self.xray.subscribers(group)));
        for plan in Plan::ALL {
            push_value(
                list,
                "plan_subs",
                plan.id(),
                Aggregation::Latest,
                Some(f64::from(self.xray.subscribers_on_plan(plan))),
            );
        }
    }

    fn push_leads(&self, list: &mut Vec<DailyValue>) {
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
        push_by_group(list, "new_subs_cum", Aggregation::Sum, |group| new_subs[group]);
        for plan in Plan::ALL {
            push_value(list, "new_subs_plan_cum", plan.id(), Aggregation::Sum, Some(new_on_plan[plan]));
        }
        push_by_group(list, "lost_leads_cum", Aggregation::Sum, |group| lost[group]);
        push_by_group(list, "leads_cum", Aggregation::Sum, |group| leads[group]);
        push_by_group(list, "leads_expected_cum", Aggregation::Sum, |group| {
            self.xray.lead_factors(group).expected()
        });
        push_by_group(list, "network_leads_cum", Aggregation::Sum, |group| {
            self.xray.lead_factors(group).network
        });
        push_sum(list, "new_leads_cum", f64::from(figures.new_leads));
        push_last_30_days(list, "new_leads_m30", f64::from(figures.new_leads));
        push_sum(list, "new_individual_leads_cum", f64::from(figures.new_individual_leads));
        push_sum(list, "new_enterprise_leads_cum", f64::from(figures.new_enterprise_leads));
        push_sum(list, "new_individual_subscribers_cum", f64::from(figures.new_individual_subscribers));
        push_sum(list, "new_ent_seats_cum", f64::from(figures.new_enterprise_seats));
        for source in Source::ALL {
            let count = facts.arrivals.iter().filter(|arrival| arrival.source == source).count();
            push_value(list, "acq_source_cum", source.id(), Aggregation::Sum, Some(count as f64));
        }
        for group in initial_groups() {
            push_value(
                list,
                "demand_mult",
                group.id(),
                Aggregation::Latest,
                Some(self.xray.lead_factors(group).saturation),
            );
        }
        for group in initial_groups() {
            let multiplier = self.xray.macro_multiplier(group, Dimension::LeadGeneration);
            push_value(list, "macro_lead_mult", group.id(), Aggregation::Latest, Some(multiplier));
        }
        let s1 = Group::at(0).expect("S1 exists");
        push_latest(list, "surge_mult", self.xray.lead_factors(s1).surge);
    }

    fn push_retention(&self, list: &mut Vec<DailyValue>) {
        let (facts, figures) = (self.xray.facts(), self.report.figures);
        let individuals = || facts.endings.iter().filter(|ending| !ending.group.is_enterprise());
        let count = |group: Group, involuntary: bool| {
            let fits = |cause: EndCause| (cause == EndCause::Involuntary) == involuntary;
            individuals().filter(|ending| ending.group == group && fits(ending.cause)).count() as f64
        };
        push_sum(list, "cancellations_cum", f64::from(figures.cancellations));
        push_by_group(list, "cancel_involuntary_cum", Aggregation::Sum, |group| count(group, true));
        push_by_group(list, "cancel_quality_or_price_cum", Aggregation::Sum, |group| count(group, false));
        push_sum(list, "upgrades_cum", f64::from(figures.upgrades));
        push_sum(list, "downgrades_cum", f64::from(figures.downgrades));
        let blocks =
            || Group::all().filter(|group| !group.is_enterprise()).flat_map(|group| self.xray.blocks(group));
        let subscribers: usize = blocks().map(|block| block.len()).sum();
        let mean = |total: f64| (subscribers > 0).then(|| total / subscribers as f64);
        let prices = blocks().flat_map(|block| &block.effective_price).sum();
        let rates = blocks().flat_map(|block| &block.usage_rate).sum();
        push_value(list, "eff_price_mean", "", Aggregation::Latest, mean(prices));
        push_value(list, "usage_rate_mean", "", Aggregation::Latest, mean(rates));
    }

    fn push_money(&self, list: &mut Vec<DailyValue>) {
        let (facts, figures) = (self.xray.facts(), self.report.figures);
        push_sum(list, "payments_received_cum", figures.payments_received);
        push_sum(list, "total_costs_cum", figures.total_costs);
        let lead_cost = self.xray.params().leads.lead_acquisition_cost;
        for category in Category::ALL {
            let booked = facts.ledger.iter().chain(self.xray.call_ledger());
            let other = booked.filter(|entry| entry.category == category);
            let value = match category {
                Category::LeadAcquisitionCost => -lead_cost * facts.arrivals.len() as f64,
                Category::SubscriptionPayment => figures.payments_received,
                _ => other.map(|entry| entry.amount).sum(),
            };
            push_value(list, "ledger_cum", category.id(), Aggregation::Sum, Some(value));
        }
    }

    fn push_service(&self, list: &mut Vec<DailyValue>) {
        let figures = self.report.figures;
        let outage = f64::from(u8::from(figures.outage));
        push_sum(list, "total_usage_cum", figures.total_usage as f64);
        push_last_30_days(list, "total_usage_m30", figures.total_usage as f64);
        push_sum(list, "overload_cum", figures.overload);
        push_last_30_days(list, "overload_m30", figures.overload);
        push_sum(list, "overload_day_cum", f64::from(u8::from(figures.overload > 0.0)));
        push_sum(list, "outage_cum", outage);
        push_last_30_days(list, "outage_m30", outage);
        push_sum(list, "downtime_minutes_cum", f64::from(figures.downtime_minutes));
        push_last_30_days(list, "p95_ms_m30", figures.p95_ms);
        push_last_30_days(list, "error_rate_m30", figures.error_rate);
        push_latest(list, "capacity_tier", f64::from(self.xray.world().settings.core.capacity_tier));
    }

    fn push_issues(&self, list: &mut Vec<DailyValue>) {
        let facts = self.xray.facts();
        push_sum(list, "issues_created_cum", facts.issues_opened.len() as f64);
        push_sum(list, "issues_resolved_cum", facts.issues_resolved.len() as f64);
        push_latest(list, "issues_open_all", self.open_issues);
        let open = || {
            let blocks = self.xray.world().customers.blocks();
            blocks.flat_map(|(_, block)| &block.open_issue_days).filter(|days| **days > 0)
        };
        let count = open().count() as f64;
        push_latest(list, "issues_open_active", count);
        let days: f64 = open().map(|days| f64::from(*days)).sum();
        push_value(list, "issue_age_mean", "", Aggregation::Latest, (count > 0.0).then(|| days / count));
    }

    fn push_satisfaction(&self, list: &mut Vec<DailyValue>) {
        for group in initial_groups() {
            push_value(
                list,
                "reputation",
                group.id(),
                Aggregation::Latest,
                Some(self.xray.reputation(group)),
            );
        }
        let moods: Vec<(Group, Option<(f64, f64)>)> =
            initial_groups().map(|group| (group, self.xray.mean_satisfaction(group))).collect();
        for (group, mood) in &moods {
            push_value(
                list,
                "sat_mean",
                group.id(),
                Aggregation::Latest,
                mood.map(|(satisfaction, _)| satisfaction),
            );
        }
        for (group, mood) in &moods {
            push_value(
                list,
                "rel_mean",
                group.id(),
                Aggregation::Latest,
                mood.map(|(_, relationship)| relationship),
            );
        }
    }

    fn push_product(&self, list: &mut Vec<DailyValue>) {
        let product = &self.xray.world().product;
        push_latest(list, "q_shared_bonus", product.shared_bonus);
        for group in initial_groups() {
            push_value(
                list,
                "q_group_bonus",
                group.id(),
                Aggregation::Latest,
                Some(product.group_bonus[group]),
            );
        }
        push_latest(list, "bank_shared", product.shared_bank);
        for group in initial_groups() {
            push_value(list, "bank_group", group.id(), Aggregation::Latest, Some(product.group_bank[group]));
        }
        let drift = &self.xray.world().market.drift;
        push_latest(list, "global_q_bias", drift.global_quality);
        for group in initial_groups() {
            push_value(list, "drift_q_bias", group.id(), Aggregation::Latest, Some(drift.quality[group]));
        }
        for group in initial_groups() {
            push_value(list, "drift_c_max", group.id(), Aggregation::Latest, Some(drift.c_max[group]));
        }
    }
}

fn push_value(
    list: &mut Vec<DailyValue>,
    figure: &'static str,
    group: &'static str,
    kind: Aggregation,
    value: Option<f64>,
) {
    list.push(DailyValue { figure, group, kind, value });
}

fn push_latest(list: &mut Vec<DailyValue>, figure: &'static str, value: f64) {
    push_value(list, figure, "", Aggregation::Latest, Some(value));
}

fn push_sum(list: &mut Vec<DailyValue>, figure: &'static str, value: f64) {
    push_value(list, figure, "", Aggregation::Sum, Some(value));
}

fn push_last_30_days(list: &mut Vec<DailyValue>, figure: &'static str, value: f64) {
    push_value(list, figure, "", Aggregation::Last30Days, Some(value));
}

/// Appends one value per initially known group, and two sums: discoverable groups of individuals and discoverable
/// groups of enterprises.
fn push_by_group(
    list: &mut Vec<DailyValue>,
    figure: &'static str,
    kind: Aggregation,
    value: impl Fn(Group) -> f64,
) {
    for group in initial_groups() {
        push_value(list, figure, group.id(), kind, Some(value(group)));
    }
    for (name, enterprise) in [("D_S*", false), ("D_E*", true)] {
        let members =
            Group::all().filter(|group| !group.is_initially_known() && group.is_enterprise() == enterprise);
        push_value(list, figure, name, kind, Some(members.map(&value).sum()));
    }
}
