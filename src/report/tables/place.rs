//! Where a line stands: in which run, when, in which week, before or after the end.

use super::{Heading, heading, rounded};
use crate::logbook::Logbook;
use novamind_session::{Line, week_of};

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

/// The columns that say it, the same in every table of lines.
pub(super) const PLACE: [Heading; 7] = [
    heading("run", "name", "name of the run"),
    heading("participant", "label", "who played"),
    heading("seq", "number", "number of the line in the trajectory, or in what was done after its end"),
    heading("at", "RFC 3339", "when the line was written"),
    heading("t", "seconds", "the same since the first line of the run, by the wall clock"),
    heading(
        "week",
        "number",
        "week that was being decided, from 1; of a closing line the week that it closes",
    ),
    heading("day", "day", "last simulated day"),
];

/// The columns of a table of lines: where they stand, and what else it tells.
pub(super) const fn with_place<const ALL: usize>(own: &[Heading]) -> [Heading; ALL] {
    let mut all = [PLACE[0]; ALL];
    let mut at = 0;
    while at < ALL {
        all[at] = if at < PLACE.len() { PLACE[at] } else { own[at - PLACE.len()] };
        at += 1;
    }
    all
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

    /// Its row: the place, and more cells.
    pub fn row<const MORE: usize>(&self, more: [String; MORE]) -> Vec<String> {
        let place = [
            self.run.to_owned(),
            self.participant.to_owned(),
            self.line.seq.to_string(),
            self.line.at.clone(),
            rounded(self.seconds),
            self.week().to_string(),
            self.line.day.to_string(),
        ];
        place.into_iter().chain(more).collect()
    }
}
