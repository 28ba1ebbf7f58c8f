//! `queries.csv`: a row for each statement to the database.

use super::column::{Column, columns};
use super::place::{LineRow, Placed, with_place};
use super::word;
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::Query;

/// The columns.
pub(super) fn columns<'a>() -> Vec<Column<LineRow<'a, &'a Query>>> {
    with_place(columns! { row: LineRow<'a, &'a Query>;
        "via", "word", "typed, library, drill_down, derived or script; empty in format 1" => row.own.via.map(|via| word(&via));
        "rows", "count", "rows of the answer; empty if there was none" => row.own.rows;
        "truncated", "0 or 1", "1: there were more rows than were shown" => row.own.truncated;
        "error", "code", "code of what was wrong; empty if nothing was" => row.own.error;
        "stopped", "0 or 1", "1: the person stopped it" => row.own.stopped;
        "took_ms", "milliseconds", "how long it took" => row.own.took_ms;
        "message", "text", "what was wrong, in words; empty in format 1" => row.own.message;
        "sql", "text", "the statement" => row.own.sql;
    })
}

/// The rows of a run.
pub(super) fn rows<'a>(lines: &'a [Placed<'a>]) -> impl Iterator<Item = LineRow<'a, &'a Query>> {
    lines.iter().filter_map(|placed| match &placed.line.record {
        Record::Query(own) => Some(LineRow { placed, own }),
        _ => None,
    })
}
