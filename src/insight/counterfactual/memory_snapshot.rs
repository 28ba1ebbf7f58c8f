//! The in-memory state of a run at the end of a day, from which the simulation can continue.

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
    /// Parameters in force at the end of the day.
    pub params: Arc<Params>,
    /// Parameter changes, including changes for later days.
    pub overrides: Overrides,
    /// Random streams of the run.
    pub streams: Streams,
    /// Names of the enterprises of the run.
    pub names: EnterpriseNames,
    /// State of the company and its market.
    pub world: World,
    /// Texts of the social feed; empty unless a recorded call replies to a post.
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
