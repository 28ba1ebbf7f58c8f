//! Figures of a group over some days, hidden ones included.

/// Figures of a group over some days: what happened on them, and how things stand at the end of the last.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeasuredGroup {
    /// Customers who came.
    pub leads: u32,
    /// Individuals who signed up, or companies whose first deal was accepted.
    pub signed: u32,
    /// Subscribers who cancelled.
    pub left: u32,
    /// Units used.
    pub usage: u64,
    /// Active subscriptions at the end.
    pub subscribers: u32,
    /// Those of them with an open issue.
    pub open_issues: u32,
    /// Reputation at the end.
    pub reputation: f64,
    /// Mean satisfaction of the subscribers; none without any.
    pub satisfaction: Option<f64>,
    /// Mean relationship of the subscribers, 0..=1; none without any.
    pub relationship: Option<f64>,
}
