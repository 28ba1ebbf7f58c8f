//! What follows from a day that was simulated or a call: words of posts, the hash of the facts, rows for the database.
//!
//! Nothing of it changes the company, so the day after is simulated meanwhile.

use std::sync::Arc;

use serde_json::Value;

use super::facts_chain::{FactsChain, StateHash, state_hash};
use super::feed::Feed;
use super::recording::{entry_of, to_fill};
use crate::database::{Entry, Projector};
use crate::session::state::Session;
use crate::world::day::step_day;
use crate::world::events::{DayFigures, Facts};
use crate::world::params::Params;
use crate::world::random::Streams;

/// The parts of a session that a day leaves its traces in.
struct Projection<'a> {
    feed: &'a mut Feed,
    facts_chain: &'a mut FactsChain,
    projector: Option<&'a Projector>,
    params: &'a Params,
    streams: &'a Streams,
}

impl Projection<'_> {
    /// Facts are not copied for the database: the writer reads what the session still shows, and the session fills new
    /// ones while the writer needs these.
    /// Nothing follows where there are no notices: nothing is left to be followed.
    fn follow(self, facts: &Arc<Facts>, notices: Option<Vec<String>>, settings: Option<Value>) {
        let Some(notices) = notices else { return };
        self.feed.word(facts, self.params, self.streams);
        self.facts_chain.add(facts);
        if let Some(projector) = self.projector {
            let entry = entry_of(facts, notices, self.feed, self.params);
            projector.write(Entry { settings, ..entry });
        }
    }
}

impl Session {
    /// Simulates a day, and meanwhile what follows from the day before, if that is left, with its notices.
    pub(in crate::session) fn simulate_day(&mut self, day_before: Option<Vec<String>>) -> DayFigures {
        std::mem::swap(&mut self.facts, &mut self.facts_before);
        let Session { world, params, streams, facts, facts_before, feed, facts_chain, projector, .. } = self;
        let projector = projector.as_ref();
        let today = to_fill(facts, projector);
        let projection = Projection { feed, facts_chain, projector, params, streams };
        let ((figures, trace), ()) = rayon::join(
            || step_day(world, params, streams, today),
            || projection.follow(facts_before, day_before, None),
        );
        self.trace = trace;
        figures
    }

    /// What follows from a call, which left this settings family if it set one.
    pub(in crate::session) fn follow_up(&mut self, settings: Option<Value>) {
        let notices = self.notice_texts();
        let Session { params, streams, facts, feed, facts_chain, projector, .. } = self;
        Projection { feed, facts_chain, projector: projector.as_ref(), params, streams }.follow(
            facts,
            Some(notices),
            settings,
        );
    }

    /// What follows from the last day of some, if there was any, with its notices; meanwhile the state is hashed.
    pub(in crate::session) fn end_days(&mut self, last_day: Option<Vec<String>>) -> StateHash {
        let Session { world, params, streams, facts, feed, facts_chain, projector, .. } = self;
        let projection = Projection { feed, facts_chain, projector: projector.as_ref(), params, streams };
        let (parts, ()) = rayon::join(|| world.part_hashes(), || projection.follow(facts, last_day, None));
        state_hash(parts, self.facts_chain.hash())
    }
}
