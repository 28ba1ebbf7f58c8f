//! `queries.csv`: a row for each SQL statement.

use super::column::{Column, columns};
use super::located_line::{LineRow, LocatedLine, with_location_columns};
use super::serialized_name;
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::Query;

pub(super) fn columns<'a>() -> Vec<Column<LineRow<'a, &'a Query>>> {
    with_location_columns(columns! { row: LineRow<'a, &'a Query>;
        "via", "word", "typed, library, drill_down, derived or script; empty in format 1" => row.row.via.map(|via| serialized_name(&via));
        "rows", "count", "number of returned rows; empty if the query failed" => row.row.rows;
        "truncated", "0 or 1", "1: the result has more rows than were shown" => row.row.truncated;
        "error", "code", "error code; empty if no error occurred" => row.row.error;
        "stopped", "0 or 1", "1: the user stopped the query" => row.row.stopped;
        "took_ms", "milliseconds", "duration" => row.row.took_ms;
        "message", "text", "error message; empty in format 1" => row.row.message;
        "sql", "text", "SQL statement" => row.row.sql;
    })
}

pub(super) fn rows<'a>(lines: &'a [LocatedLine<'a>]) -> impl Iterator<Item = LineRow<'a, &'a Query>> {
    lines.iter().filter_map(|placed| match &placed.line.record {
        Record::Query(query) => Some(LineRow { located: placed, row: query }),
        _ => None,
    })
}
