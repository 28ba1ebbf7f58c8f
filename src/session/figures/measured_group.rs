//! Figures of a group over some days, hidden ones included.

use super::groups::GroupWeek;
use super::mood::mood_of;
use novamind_world::customers::columns::Block;
use novamind_world::identifiers::Group;
use novamind_world::state::World;

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

impl MeasuredGroup {
    /// Of a world at the end of days on which so much was counted.
    pub fn of(group: Group, counted: &GroupWeek, world: &World) -> MeasuredGroup {
        let (satisfaction, relationship) = mood_of(world, group).unzip();
        let own = &world.customers.groups[group];
        MeasuredGroup {
            leads: counted.leads,
            signed: counted.signed,
            left: counted.left,
            usage: counted.usage.0.iter().sum(),
            subscribers: own.active(),
            open_issues: own.blocks.iter().map(Block::open_issues).sum(),
            reputation: world.market.reputation.of(group),
            satisfaction,
            relationship,
        }
    }
}
