//! Which advertising channel truly is the best for a group, by the yields that no player sees.

use crate::state::Session;
use novamind_world::identifiers::{Channel, Group};
use novamind_world::params::Params;

/// The channel with the highest starting yield for a group; the first in channel order on a tie.
pub fn best_starting_channel(group: Group, params: &Params) -> Channel {
    let yields = params.starting_yields();
    let better =
        |best: Channel, next: Channel| if yields[next][group] > yields[best][group] { next } else { best };
    Channel::ALL.into_iter().reduce(better).unwrap_or(Channel::ALL[0])
}

impl Session {
    /// The channel that brought a group most leads per dollar when the run began: what no player sees, so only runs that
    /// are over tell it.
    pub fn truly_best_channel(&self, group: Group) -> Option<Channel> {
        self.ended().map(|_| best_starting_channel(group, &self.simulation.params))
    }
}
