//! Location of a line in a study: run, time, week, and whether it follows the end of the run.

use super::column::{Column, columns};
use super::rounded;
use crate::logbook::Logbook;
use novamind_record::trajectory::Line;
use novamind_session::week_of_day;

pub(super) struct LocatedLine<'a> {
    pub line: &'a Line,
    run: &'a str,
    participant: &'a str,
    /// Whether the line was written after the end of the run.
    pub is_after_end: bool,
    seconds: f64,
}

/// A table row about a line: the line with its location, and the values for the table's own columns.
pub(super) struct LineRow<'a, T> {
    pub located: &'a LocatedLine<'a>,
    pub row: T,
}

/// Prepends the location columns, which all tables about lines have.
pub(super) fn with_location_columns<'a, T>(
    row_columns: Vec<Column<LineRow<'a, T>>>,
) -> Vec<Column<LineRow<'a, T>>> {
    let place = columns! { row: LineRow<'a, T>;
        "run", "name", "name of the run" => row.located.run;
        "participant", "label", "label of the participant" => row.located.participant;
        "seq", "number", "number of the line in the trajectory or in afterwards.jsonl" => row.located.line.seq;
        "at", "RFC 3339", "time when the line was written" => row.located.line.at;
        "t", "seconds", "wall-clock time since the first line of the run" => rounded(row.located.seconds);
        "week", "number", "week being decided, from 1; for a closing line, the closed week" => row.located.week();
        "day", "day", "last simulated day" => row.located.line.day;
    };
    place.into_iter().chain(row_columns).collect()
}

pub(super) fn locate_lines<'a>(
    book: &'a Logbook,
    lines: &'a [Line],
    afterwards: &'a [Line],
) -> Vec<LocatedLine<'a>> {
    let began = lines.first().map_or(0, Line::at_nanoseconds);
    let place = |line: &'a Line, is_afterwards: bool| LocatedLine {
        line,
        run: &book.run,
        participant: book.participant.as_deref().unwrap_or_default(),
        is_after_end: is_afterwards,
        seconds: (line.at_nanoseconds() - began) as f64 / 1e9,
    };
    let trajectory_lines = lines.iter().map(|line| place(line, false));
    trajectory_lines.chain(afterwards.iter().map(|line| place(line, true))).collect()
}

impl LocatedLine<'_> {
    /// Returns the week that is being decided. For a closing line, returns the closed week.
    pub fn week(&self) -> u32 {
        let is_closed = self.line.closes_days() || self.is_after_end || self.line.record.kind() == "end";
        week_of_day(if is_closed { self.line.day } else { self.line.day + 1 })
    }
}
