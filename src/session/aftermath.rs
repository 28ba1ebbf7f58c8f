//! What follows from a day that was simulated or a call: words of posts, the hash of the facts, rows for the database.
//!
//! Nothing of it changes the company, so the day after is simulated meanwhile.

use std::sync::Arc;

use super::Session;
use super::feed::Feed;
use super::record::{FactsChain, entry_of, to_fill};
use crate::database::Projector;
use crate::world::day::step_day;
use crate::world::events::{DayFigures, Facts};
use crate::world::params::Params;
use crate::world::random::Streams;
use crate::world::state::PartHash;

/// The parts of a session that a day leaves its traces in.
struct Aftermath<'a> {
    feed: &'a mut Feed,
    facts_chain: &'a mut FactsChain,
    projector: Option<&'a Projector>,
    params: &'a Params,
    streams: &'a Streams,
}

impl Aftermath<'_> {
    /// Facts are not copied for the database: the writer reads what the session still shows, and the session fills new
    /// ones while the writer needs these.
    fn follow(self, facts: &Arc<Facts>, notices: Vec<String>) {
        self.feed.word(facts, self.params, self.streams);
        self.facts_chain.add(facts);
        if let Some(projector) = self.projector {
            projector.write(entry_of(facts, notices, self.feed, self.params));
        }
    }
}

impl Session {
    /// Simulates a day, and meanwhile what follows from the day before, if that is left, with its notices.
    pub(super) fn simulate_day(&mut self, day_before: Option<Vec<String>>) -> DayFigures {
        std::mem::swap(&mut self.facts, &mut self.facts_before);
        let Session { world, params, streams, facts, facts_before, feed, facts_chain, projector, .. } = self;
        let projector = projector.as_ref();
        let today = to_fill(facts, projector);
        let aftermath = Aftermath { feed, facts_chain, projector, params, streams };
        let ((figures, trace), ()) = rayon::join(
            || step_day(world, params, streams, today),
            || {
                if let Some(notices) = day_before {
                    aftermath.follow(facts_before, notices);
                }
            },
        );
        self.trace = trace;
        figures
    }

    /// What follows from a call.
    pub(super) fn follow_up(&mut self) {
        let notices = self.notice_texts();
        let Session { params, streams, facts, feed, facts_chain, projector, .. } = self;
        Aftermath { feed, facts_chain, projector: projector.as_ref(), params, streams }
            .follow(facts, notices);
    }

    /// What follows from the last day of some, if there was any, with its notices; meanwhile the state is hashed.
    /// Returns the hashes of its parts.
    pub(super) fn end_days(&mut self, last_day: Option<Vec<String>>) -> Vec<PartHash> {
        let Session { world, params, streams, facts, feed, facts_chain, projector, .. } = self;
        let aftermath = Aftermath { feed, facts_chain, projector: projector.as_ref(), params, streams };
        let follow = || {
            if let Some(notices) = last_day {
                aftermath.follow(facts, notices);
            }
        };
        rayon::join(|| world.part_hashes(), follow).0
    }
}
