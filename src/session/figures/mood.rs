//! How content a group is, and all its figures.

use super::groups::GroupWeek;
use novamind_record::figures::MeasuredGroup;
use novamind_world::customers::columns::Block;
use novamind_world::identifiers::Group;
use novamind_world::state::World;

/// Mean satisfaction and relationship of a group's active subscribers; none without any.
pub fn mood_of(world: &World, group: Group) -> Option<(f64, f64)> {
    let blocks = || world.customers.groups[group].blocks.iter();
    let count: usize = blocks().map(Block::len).sum();
    let satisfaction: f64 = blocks().flat_map(|block| &block.satisfaction).sum();
    let relationship: f64 = blocks().flat_map(|block| &block.relationship).sum();
    (count > 0).then(|| (satisfaction / count as f64, relationship / count as f64))
}

/// Figures of a group in a world at the end of days on which `counted` was counted.
pub fn measured_group(group: Group, counted: &GroupWeek, world: &World) -> MeasuredGroup {
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
