//! Facts with the words that belong to them, for the database.

use std::sync::Arc;

use super::feed::Feed;
use crate::database::Entry;
use crate::voice;
use crate::world::events::{Facts, Sender};
use crate::world::params::Params;

/// The facts of a day or call with the words that belong to them.
pub(in crate::session) fn entry_of(
    facts: &Arc<Facts>,
    notices: Vec<String>,
    feed: &Feed,
    params: &Params,
) -> Entry {
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
