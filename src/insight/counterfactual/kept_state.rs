//! A moment of a run, kept in memory: what everything after it follows from.

use std::sync::Arc;

use novamind_record::folder::manifest::Manifest;
use novamind_session::engine::{Feed, Overrides, Simulation};
use novamind_voice::CompanyNames;
use novamind_world::params::Params;
use novamind_world::random::Streams;
use novamind_world::state::World;

/// A company at the end of a day, before anything is decided on it.
#[derive(Clone)]
pub(crate) struct KeptState {
    /// Parameters in force.
    pub params: Arc<Params>,
    /// What was set of them, and what waits for its day.
    pub overrides: Overrides,
    /// Its luck.
    pub streams: Streams,
    /// What its companies are called.
    pub names: CompanyNames,
    /// The company and its market.
    pub world: World,
    /// What was written in public; empty unless a call needs the words.
    pub feed: Feed,
}

impl KeptState {
    /// Day 0 of a run.
    pub(crate) fn opening(manifest: &Manifest, params: Arc<Params>) -> KeptState {
        KeptState::of(Simulation::open(manifest, params))
    }

    /// The moment a simulation has come to.
    pub(crate) fn of(simulation: Simulation) -> KeptState {
        let Simulation { params, overrides, streams, names, world, feed, .. } = simulation;
        KeptState { params, overrides, streams, names, world, feed }
    }
}
