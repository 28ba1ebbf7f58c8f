//! Figures of a group over a period, including hidden ones.

/// Figures of a group over a period: sums over its days, and the state at its end.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GroupFigures {
    /// Leads.
    pub leads: u32,
    /// Individuals who signed up, or enterprises whose first deal was accepted.
    pub signed: u32,
    /// Cancellations.
    pub left: u32,
    /// Usage in units.
    pub usage: u64,
    /// Active subscriptions at the end.
    pub subscribers: u32,
    /// Active subscriptions with an open issue.
    pub open_issues: u32,
    /// Reputation at the end.
    pub reputation: f64,
    /// Mean satisfaction of the subscribers; `None` without subscribers.
    pub satisfaction: Option<f64>,
    /// Mean relationship of the subscribers, 0 to 1; `None` without subscribers.
    pub relationship: Option<f64>,
}
