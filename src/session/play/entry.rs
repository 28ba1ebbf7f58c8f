//! Facts with the words that belong to them, for the database.

use std::sync::Arc;

use super::feed::Feed;
use novamind_database::Entry;
use novamind_world::events::{Facts, Sender};
use novamind_world::params::Params;

/// The facts of a day or call with the words that belong to them.
pub(crate) fn entry_of(facts: &Arc<Facts>, notices: Vec<String>, feed: &Feed, params: &Params) -> Entry {
    let companies = facts.arrivals.iter().filter(|arrival| arrival.group.is_enterprise());
    let writers = facts.turns.iter().filter(|turn| turn.sender == Sender::Customer);
    let named = companies.map(|arrival| arrival.customer).chain(writers.map(|turn| turn.customer));
    let personas = &params.personas;
    Entry {
        notices,
        readings: facts.readings.iter().map(novamind_voice::reading).collect(),
        turns: facts.turns.iter().map(|turn| novamind_voice::message(turn, personas)).collect(),
        posts: feed.words_of(facts),
        addresses: named
            .map(|customer| (customer, novamind_voice::address(customer, &personas.email)))
            .collect(),
        facts: facts.clone(),
        ..Entry::default()
    }
}
