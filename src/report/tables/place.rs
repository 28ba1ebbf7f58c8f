//! Where a line stands: in which run, when, in which week, before or after the end.

use super::column::{Column, columns};
use super::rounded;
use crate::logbook::Logbook;
use novamind_record::trajectory::Line;
use novamind_session::week_of;

/// A line with its place.
pub(super) struct Placed<'a> {
    pub line: &'a Line,
    run: &'a str,
    participant: &'a str,
    /// It was written after the end of the run.
    pub is_afterwards: bool,
    /// Seconds since the first line.
    seconds: f64,
}

/// A row of a table of lines: a line with its place, and what else the table tells.
pub(super) struct LineRow<'a, T> {
    pub placed: &'a Placed<'a>,
    pub own: T,
}

/// The columns of a table of lines: those of the place, the same in every such table, before its own.
pub(super) fn with_place<'a, T>(own: Vec<Column<LineRow<'a, T>>>) -> Vec<Column<LineRow<'a, T>>> {
    let place = columns! { row: LineRow<'a, T>;
        "run", "name", "name of the run" => row.placed.run;
        "participant", "label", "who played" => row.placed.participant;
        "seq", "number", "number of the line in the trajectory, or in what was done after its end" => row.placed.line.seq;
        "at", "RFC 3339", "when the line was written" => row.placed.line.at;
        "t", "seconds", "the same since the first line of the run, by the wall clock" => rounded(row.placed.seconds);
        "week", "number", "week that was being decided, from 1; of a closing line the week that it closes" => row.placed.week();
        "day", "day", "last simulated day" => row.placed.line.day;
    };
    place.into_iter().chain(own).collect()
}

/// All lines of a run with their places.
pub(super) fn placed<'a>(book: &'a Logbook, lines: &'a [Line], afterwards: &'a [Line]) -> Vec<Placed<'a>> {
    let began = lines.first().map_or(0, Line::nanoseconds);
    let place = |line: &'a Line, is_afterwards: bool| Placed {
        line,
        run: &book.run,
        participant: book.participant.as_deref().unwrap_or_default(),
        is_afterwards,
        seconds: (line.nanoseconds() - began) as f64 / 1e9,
    };
    let own = lines.iter().map(|line| place(line, false));
    own.chain(afterwards.iter().map(|line| place(line, true))).collect()
}

impl Placed<'_> {
    /// Week that was being decided; that which a closing line closes.
    pub fn week(&self) -> u32 {
        let is_closed = self.line.closes_days() || self.is_afterwards || self.line.record.kind() == "end";
        week_of(if is_closed { self.line.day } else { self.line.day + 1 })
    }
}
