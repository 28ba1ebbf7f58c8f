//! The state of a run at the end of a day, in memory, from which simulation can continue.

use std::sync::Arc;

use novamind_record::folder::manifest::Manifest;
use novamind_session::engine::{Feed, Overrides, Simulation};
use novamind_voice::CompanyNames;
use novamind_world::params::Params;
use novamind_world::random::Streams;
use novamind_world::state::World;

/// The state at the end of a day, before the decisions of that day.
#[derive(Clone)]
pub(crate) struct KeptState {
    /// Parameters in force.
    pub params: Arc<Params>,
    /// Parameter changes, including those for later days.
    pub overrides: Overrides,
    /// Random streams.
    pub streams: Streams,
    /// Names of enterprises.
    pub names: CompanyNames,
    /// The company and its market.
    pub world: World,
    /// Texts of posts; empty unless a call needs them.
    pub feed: Feed,
}

impl KeptState {
    /// Creates the state of day 0.
    pub(crate) fn opening(manifest: &Manifest, params: Arc<Params>) -> KeptState {
        KeptState::of(Simulation::open(manifest, params))
    }

    /// Captures the current state of a simulation.
    pub(crate) fn of(simulation: Simulation) -> KeptState {
        let Simulation { params, overrides, streams, names, world, feed, .. } = simulation;
        KeptState { params, overrides, streams, names, world, feed }
    }
}
