//! What a session records besides its lines: rows for the database, and the state hash.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Session;
use super::error::RunError;
use super::feed::Feed;
use super::trajectory::{Durability, Record};
use crate::database::{Entry, Projector};
use crate::voice;
use crate::world::canonical::hash_of;
use crate::world::events::{Facts, Sender};
use crate::world::params::Params;
use crate::world::state::{PartHash, combined_hash};

/// Hash of the state and of the week's facts, with the hash of each part by its name.
pub(super) type StateHash = (String, BTreeMap<String, String>);

/// Hash of a state with these parts and of the week's facts.
pub(super) fn state_hash(mut parts: Vec<PartHash>, facts: blake3::Hash) -> StateHash {
    parts.push(PartHash { part: "facts", hash: facts });
    let short = |hash: &blake3::Hash| hash.to_hex()[..16].to_owned();
    let by_name = parts.iter().map(|part| (part.part.to_owned(), short(&part.hash))).collect();
    (combined_hash(&parts).to_hex().to_string(), by_name)
}

/// The facts of a week, day by day and call by call, as one hash.
pub(super) struct FactsChain {
    hash: blake3::Hash,
    /// The week is over: what comes next begins a new chain.
    closed: bool,
}

impl Default for FactsChain {
    fn default() -> Self {
        FactsChain { hash: blake3::hash(b""), closed: false }
    }
}

impl FactsChain {
    /// Adds the facts of a day or call.
    pub(super) fn add(&mut self, facts: &Facts) {
        if self.closed {
            *self = FactsChain::default();
        }
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.hash.as_bytes());
        hasher.update(hash_of(facts).as_bytes());
        self.hash = hasher.finalize();
    }

    /// The chain with this hash, of a week that is over or still runs.
    pub(super) fn resume(hash: blake3::Hash, closed: bool) -> FactsChain {
        FactsChain { hash, closed }
    }

    /// Whether the week is over.
    pub(super) fn is_closed(&self) -> bool {
        self.closed
    }

    /// Ends the week.
    pub(super) fn close(&mut self) {
        self.closed = true;
    }

    /// Hash of the week so far, or of the one that just ended.
    pub(super) fn hash(&self) -> blake3::Hash {
        self.hash
    }
}

/// Facts to be filled: these if nobody reads them any more, else some that the writer of the database has done with, or
/// new ones. The facts of a day that is not handed over yet stay.
pub(super) fn to_fill<'a>(facts: &'a mut Arc<Facts>, projector: Option<&Projector>) -> &'a mut Facts {
    if Arc::strong_count(facts) > 1 {
        *facts = projector.and_then(Projector::spare_facts).unwrap_or_default();
    }
    Arc::make_mut(facts)
}

/// The facts of a day or call with the words that belong to them.
pub(super) fn entry_of(facts: &Arc<Facts>, notices: Vec<String>, feed: &Feed, params: &Params) -> Entry {
    let companies = facts.arrivals.iter().filter(|arrival| arrival.group.is_enterprise());
    let writers = facts.turns.iter().filter(|turn| turn.sender == Sender::Customer);
    let named = companies.map(|arrival| arrival.customer).chain(writers.map(|turn| turn.customer));
    let personas = &params.personas;
    Entry {
        notices,
        readings: facts.readings.iter().map(voice::reading).collect(),
        turns: facts.turns.iter().map(|turn| voice::message(turn, personas)).collect(),
        posts: feed.words_of(facts),
        addresses: named.map(|customer| (customer, voice::address(customer, &personas.email))).collect(),
        facts: facts.clone(),
        ..Entry::default()
    }
}

impl Session {
    /// The facts of day 0 with the words that belong to them.
    pub(super) fn entry(&self) -> Entry {
        entry_of(&self.facts, self.notice_texts(), &self.feed, &self.params)
    }

    /// Makes everything handed over visible, as of the last line.
    pub(super) fn commit_projection(&self) {
        if let Some(projector) = &self.projector {
            projector.commit(self.position.clone());
        }
    }

    /// Appends a line; a run that is only read has none.
    pub(super) fn append(&mut self, record: &Record, durability: Durability) -> Result<String, RunError> {
        let Some(trajectory) = &mut self.trajectory else { return Ok(String::new()) };
        let at = trajectory.append(self.world.day, record, durability)?;
        self.position = trajectory.position();
        Ok(at)
    }

    /// Appends a line about something that cannot be taken back. Returns what keeps it from the disk for now.
    pub(super) fn append_done(&mut self, record: &Record) -> Option<String> {
        let trajectory = self.trajectory.as_mut()?;
        let written = trajectory.append_done(self.world.day, record);
        self.position = trajectory.position();
        written.err().map(|error| error.to_string())
    }
}
