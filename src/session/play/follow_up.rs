//! What follows from a day that was simulated or a call: words of posts, the hash of the facts, rows for the database.
//!
//! Nothing of it changes the company, so the day after is simulated meanwhile.

use std::sync::Arc;

use serde_json::Value;

use super::facts_chain::{FactsChain, StateHash, state_hash};
use super::feed::Feed;
use super::projection::Entries;
use super::recording::{entry_of, to_fill};
use crate::database::Entry;
use crate::session::state::Session;
use crate::world::day::step_day;
use crate::world::events::{DayFigures, Facts};
use crate::world::params::Params;
use crate::world::random::Streams;

/// The parts of a session that a day leaves its traces in.
struct FollowUp<'a> {
    feed: &'a mut Feed,
    facts_chain: &'a mut FactsChain,
    entries: Entries<'a>,
    params: &'a Params,
    streams: &'a Streams,
}

impl FollowUp<'_> {
    /// Facts are not copied for the database: the writer reads what the session still shows, and the session fills new
    /// ones while the writer needs these.
    /// Nothing follows where there are no notices: nothing is left to be followed.
    fn follow(self, facts: &Arc<Facts>, notices: Option<Vec<String>>, settings: Option<Value>) {
        let Some(notices) = notices else { return };
        self.feed.word(facts, self.params, self.streams);
        self.facts_chain.add(facts);
        let FollowUp { feed, params, entries, .. } = self;
        entries.write(|| Entry { settings, ..entry_of(facts, notices, feed, params) });
    }
}

impl Session {
    /// Simulates a day, and meanwhile what follows from the day before, if that is left, with its notices.
    pub(in crate::session) fn simulate_day(&mut self, day_before: Option<Vec<String>>) -> DayFigures {
        std::mem::swap(&mut self.facts, &mut self.facts_before);
        let Session { world, params, streams, facts, facts_before, feed, facts_chain, projection, .. } = self;
        let today = to_fill(facts, projection.entries());
        let follow_up = FollowUp { feed, facts_chain, entries: projection.entries(), params, streams };
        let ((figures, trace), ()) = rayon::join(
            || step_day(world, params, streams, today),
            || follow_up.follow(facts_before, day_before, None),
        );
        self.trace = trace;
        figures
    }

    /// What follows from a call, which left this settings family if it set one.
    pub(in crate::session) fn follow_up(&mut self, settings: Option<Value>) {
        let notices = self.notice_texts();
        let Session { params, streams, facts, feed, facts_chain, projection, .. } = self;
        FollowUp { feed, facts_chain, entries: projection.entries(), params, streams }.follow(
            facts,
            Some(notices),
            settings,
        );
    }

    /// What follows from the last day of some, if there was any, with its notices; meanwhile the state is hashed.
    pub(in crate::session) fn end_days(&mut self, last_day: Option<Vec<String>>) -> StateHash {
        let Session { world, params, streams, facts, feed, facts_chain, projection, .. } = self;
        let follow_up = FollowUp { feed, facts_chain, entries: projection.entries(), params, streams };
        let (parts, ()) = rayon::join(|| world.part_hashes(), || follow_up.follow(facts, last_day, None));
        state_hash(parts, self.facts_chain.hash())
    }
}
