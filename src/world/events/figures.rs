//! Figures of one day.

use crate::identifiers::{ByGroup, ByPlan};

/// Figures of a day (`docs/mechanics/day.md#figures-of-a-day`).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DayFigures {
    /// Day.
    pub day: u32,
    /// Units used.
    pub total_usage: u64,
    /// The same by group and by the plan they were used on.
    pub usage: ByGroup<ByPlan<u64>>,
    /// Usage above capacity.
    pub overload: f64,
    /// Whether there was an outage.
    pub outage: bool,
    /// Minutes of downtime.
    pub downtime_minutes: u32,
    /// Latency in milliseconds.
    pub p95_ms: f64,
    /// Share of failed requests.
    pub error_rate: f64,
    /// All leads, including lost ones.
    pub new_leads: u32,
    /// Leads of individuals.
    pub new_individual_leads: u32,
    /// Leads of enterprises that opened a thread.
    pub new_enterprise_leads: u32,
    /// Individuals who signed up.
    pub new_individual_subscribers: u32,
    /// Seats of enterprises that signed today.
    pub new_enterprise_seats: u32,
    /// Cancellations of individuals, including involuntary ones.
    pub cancellations: u32,
    /// Switches to a more expensive plan.
    pub upgrades: u32,
    /// Switches to a cheaper plan.
    pub downgrades: u32,
    /// Payments of subscribers, dollars.
    pub payments_received: f64,
    /// Running costs: capacity, compute, operations, development, advertising; dollars.
    pub total_costs: f64,
    /// Cash at the end of the day, dollars.
    pub cash: f64,
    /// Monthly recurring revenue at the end of the day, dollars.
    pub mrr: f64,
    /// Active subscriptions of individuals.
    pub individual_subscribers: u32,
    /// Seats of active enterprises.
    pub enterprise_seats: u32,
}
