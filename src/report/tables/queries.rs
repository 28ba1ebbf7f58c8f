//! `queries.csv`: a row for each SQL statement.

use super::column::{Column, columns};
use super::place::{LineRow, Placed, with_place};
use super::word;
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::Query;

pub(super) fn columns<'a>() -> Vec<Column<LineRow<'a, &'a Query>>> {
    with_place(columns! { row: LineRow<'a, &'a Query>;
        "via", "word", "typed, library, drill_down, derived or script; empty in format 1" => row.own.via.map(|via| word(&via));
        "rows", "count", "number of returned rows; empty if it failed" => row.own.rows;
        "truncated", "0 or 1", "1: more rows existed than were shown" => row.own.truncated;
        "error", "code", "error code; empty without an error" => row.own.error;
        "stopped", "0 or 1", "1: the user stopped it" => row.own.stopped;
        "took_ms", "milliseconds", "duration" => row.own.took_ms;
        "message", "text", "error message; empty in format 1" => row.own.message;
        "sql", "text", "the statement" => row.own.sql;
    })
}

pub(super) fn rows<'a>(lines: &'a [Placed<'a>]) -> impl Iterator<Item = LineRow<'a, &'a Query>> {
    lines.iter().filter_map(|placed| match &placed.line.record {
        Record::Query(own) => Some(LineRow { placed, own }),
        _ => None,
    })
}
