//! Daily figures of the company.

use crate::identifiers::{ByGroup, ByPlan};

/// Figures of the company on one day (`docs/mechanics/day.md#figures-of-a-day`).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DayFigures {
    /// Day to which the figures belong.
    pub day: u32,
    /// Units used by all customers.
    pub total_usage: u64,
    /// Units used, by group and plan.
    pub usage: ByGroup<ByPlan<u64>>,
    /// Usage above capacity, as a share of capacity.
    pub overload: f64,
    /// Whether the service had an outage.
    pub outage: bool,
    /// Downtime of the service, in minutes.
    pub downtime_minutes: u32,
    /// 95th percentile of the latency, in milliseconds.
    pub p95_ms: f64,
    /// Share of failed requests.
    pub error_rate: f64,
    /// Number of leads, including lost leads.
    pub new_leads: u32,
    /// Number of individual leads.
    pub new_individual_leads: u32,
    /// Number of enterprise leads that opened a thread.
    pub new_enterprise_leads: u32,
    /// Number of individuals who signed up.
    pub new_individual_subscribers: u32,
    /// Seats of enterprises that became subscribers today.
    pub new_enterprise_seats: u32,
    /// Number of individual cancellations, including failed payments.
    pub cancellations: u32,
    /// Number of switches to a higher-priced plan.
    pub upgrades: u32,
    /// Number of switches to a lower-priced plan.
    pub downgrades: u32,
    /// Payments of subscribers, dollars.
    pub payments_received: f64,
    /// Running costs in dollars: capacity, compute, operations, development and advertising.
    pub total_costs: f64,
    /// Cash at the end of the day, dollars.
    pub cash: f64,
    /// Monthly recurring revenue at the end of the day, dollars.
    pub mrr: f64,
    /// Number of active individual subscriptions at the end of the day.
    pub individual_subscribers: u32,
    /// Whole seats of all subscribed enterprises at the end of the day.
    pub enterprise_seats: u32,
}
