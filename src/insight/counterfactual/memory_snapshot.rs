//! The state of a run at the end of a day, in memory, from which simulation can continue.

use std::sync::Arc;

use novamind_record::folder::manifest::Manifest;
use novamind_session::engine::{Feed, Overrides, Simulation};
use novamind_voice::EnterpriseNames;
use novamind_world::params::Params;
use novamind_world::random::Streams;
use novamind_world::state::World;

/// The state at the end of a day, before the decisions of that day.
#[derive(Clone)]
pub(crate) struct MemorySnapshot {
    /// Parameters in force.
    pub params: Arc<Params>,
    /// Parameter changes, including those for later days.
    pub overrides: Overrides,
    /// Random streams.
    pub streams: Streams,
    /// Names of enterprises.
    pub names: EnterpriseNames,
    /// The company and its market.
    pub world: World,
    /// Texts of posts; empty unless a call needs them.
    pub feed: Feed,
}

impl MemorySnapshot {
    /// Creates the state of day 0.
    pub(crate) fn at_day_0(manifest: &Manifest, params: Arc<Params>) -> MemorySnapshot {
        MemorySnapshot::from_simulation(Simulation::new(manifest, params))
    }

    /// Captures the current state of a simulation.
    pub(crate) fn from_simulation(simulation: Simulation) -> MemorySnapshot {
        let Simulation { params, overrides, streams, names, world, feed, .. } = simulation;
        MemorySnapshot { params, overrides, streams, names, world, feed }
    }
}
