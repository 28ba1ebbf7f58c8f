//! How content a group is.

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
