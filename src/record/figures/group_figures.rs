//! Figures of a group over a period, including hidden figures.

/// Figures of a group over a period: sums over the days of the period, and the state on the last day.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GroupFigures {
    /// Leads during the period.
    pub leads: u32,
    /// Number of individuals who signed up, or of enterprises that accepted a first deal.
    pub signed: u32,
    /// Cancellations during the period.
    pub left: u32,
    /// Usage during the period, in units.
    pub usage: u64,
    /// Active subscriptions at the end of the period.
    pub subscribers: u32,
    /// Active subscriptions with an open issue at the end of the period.
    pub open_issues: u32,
    /// Reputation at the end of the period.
    pub reputation: f64,
    /// Mean satisfaction of the subscribers; `None` if there are no subscribers.
    pub satisfaction: Option<f64>,
    /// Mean relationship of the subscribers, 0 to 1; `None` if there are no subscribers.
    pub relationship: Option<f64>,
}
