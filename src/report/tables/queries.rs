//! `queries.csv`: a row for each statement to the database.

use super::place::{PLACE, Placed, with_place};
use super::{Heading, flag, heading, number, word};
use novamind_session::Record;
use novamind_session::record::Query;

const OWN: [Heading; 8] = [
    heading("via", "word", "typed, library, drill_down, derived or script; empty in format 1"),
    heading("rows", "count", "rows of the answer; empty if there was none"),
    heading("truncated", "0 or 1", "1: there were more rows than were shown"),
    heading("error", "code", "code of what was wrong; empty if nothing was"),
    heading("stopped", "0 or 1", "1: the person stopped it"),
    heading("took_ms", "milliseconds", "how long it took"),
    heading("message", "text", "what was wrong, in words; empty in format 1"),
    heading("sql", "text", "the statement"),
];

/// The columns.
pub(super) const HEADINGS: [Heading; PLACE.len() + OWN.len()] = with_place(&OWN);

/// The rows of a run.
pub(super) fn rows(lines: &[Placed<'_>]) -> Vec<Vec<String>> {
    let row = |placed: &Placed<'_>| match &placed.line.record {
        Record::Query(query) => Some(placed.row(cells(query))),
        _ => None,
    };
    lines.iter().filter_map(row).collect()
}

fn cells(query: &Query) -> [String; OWN.len()] {
    [
        query.via.map(|via| word(&via)).unwrap_or_default(),
        query.rows.map(|rows| rows.to_string()).unwrap_or_default(),
        flag(query.truncated),
        query.error.clone().unwrap_or_default(),
        flag(query.stopped),
        number(query.took_ms),
        query.message.clone().unwrap_or_default(),
        query.sql.clone(),
    ]
}
