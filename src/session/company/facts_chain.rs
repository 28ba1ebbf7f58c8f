//! The state hash: a hash of all parts of the world and of the facts of the week.

use std::collections::BTreeMap;

use novamind_world::canonical::canonical_hash;
use novamind_world::events::Facts;
use novamind_world::state::{PartHash, combined_hash};

/// Hash of the state including the facts of the week, and the short hash of each part by name.
pub type StateHash = (String, BTreeMap<String, String>);

pub(crate) fn state_hash(mut parts: Vec<PartHash>, facts: blake3::Hash) -> StateHash {
    parts.push(PartHash { part: "facts", hash: facts });
    let short = |hash: &blake3::Hash| hash.to_hex()[..16].to_owned();
    let by_name = parts.iter().map(|part| (part.part.to_owned(), short(&part.hash))).collect();
    (combined_hash(&parts).to_hex().to_string(), by_name)
}

/// A hash chain over the facts of a week, with one link per day and per call.
pub(crate) struct FactsChain {
    hash: blake3::Hash,
    /// Whether the week has ended, so that the next facts start a new chain.
    is_closed: bool,
}

impl Default for FactsChain {
    fn default() -> Self {
        FactsChain { hash: blake3::hash(b""), is_closed: false }
    }
}

impl FactsChain {
    pub(crate) fn add(&mut self, facts: &Facts) {
        if self.is_closed {
            *self = FactsChain::default();
        }
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.hash.as_bytes());
        hasher.update(canonical_hash(facts).as_bytes());
        self.hash = hasher.finalize();
    }

    pub(crate) fn from_hash(hash: blake3::Hash, closed: bool) -> FactsChain {
        FactsChain { hash, is_closed: closed }
    }

    pub(crate) fn is_closed(&self) -> bool {
        self.is_closed
    }

    pub(crate) fn close(&mut self) {
        self.is_closed = true;
    }

    /// Returns the hash of the current week, or of the last week if no facts were added since its end.
    pub(crate) fn hash(&self) -> blake3::Hash {
        self.hash
    }
}
