//! What a command of the laboratory shows: tables of typed cells, graphs, and notes under them.
//!
//! The same exhibit is a table for a terminal ([`Exhibit::as_text`]), comma-separated values ([`Tabulation::as_csv`]), JSON
//! ([`Exhibit::as_json`]) and a drawing ([`Exhibit::as_svg`]). The last three hold every number in full.

mod data;
mod graph;
mod text;

pub use graph::{Graph, GraphAxis, GraphForm, Series};
pub use novamind_report::plot::AxisScale;

use novamind_base::notation::{dollars, grouped, percent, short_dollars};
use novamind_base::statistics::Interval;

/// Widest table, unless more is asked for.
pub const WIDTH: usize = 100;

/// What a command of the laboratory shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Exhibit {
    /// What it is about.
    pub title: String,
    /// Tables; the first one is the result.
    pub tables: Vec<Tabulation>,
    /// Graphs.
    pub graphs: Vec<Graph>,
    /// Sentences under it: what was assumed, what figures mean, where they come from.
    pub notes: Vec<String>,
}

/// A table of an exhibit.
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulation {
    /// Name for programs: `--table NAME` asks for it.
    pub name: String,
    /// What stands above it; empty for nothing.
    pub caption: String,
    /// Columns.
    pub columns: Vec<Column>,
    /// Cells by row, one for each column.
    pub rows: Vec<Vec<Datum>>,
    /// Rows that sum the others up: people read them below a rule, programs apart from the rows.
    pub summary: Vec<Vec<Datum>>,
    /// It is too long for people, who are told how to get it.
    pub is_for_programs: bool,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Name for programs, as [`column_name`] makes it of a text.
    pub name: String,
    /// Name for people; it may be broken at blanks.
    pub heading: String,
    /// What its cells hold.
    pub holds: Holds,
}

/// What the cells of a column hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    /// Words; they stand at the left.
    Words,
    /// Numbers; they stand at the right.
    Numbers(Measure),
    /// Intervals: two numbers for programs.
    Intervals(Measure),
    /// Drawings of signs, for people only.
    Drawings,
}

/// What a number measures, and how people read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Dollars.
    Dollars,
    /// How many.
    Count,
    /// Days.
    Days,
    /// A part of a whole, 1 for all of it.
    Share,
    /// Millions of dollars, with a decimal.
    Millions,
    /// Anything else, with so many decimals.
    Number(usize),
}

/// What stands in a cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Datum {
    /// Words.
    Words(String),
    /// A number of the column's measure.
    Number(f64),
    /// A number of a measure of its own, in a table whose rows measure different things.
    Measured(f64, Measure),
    /// An interval of the column's measure.
    Interval(Interval),
    /// Nothing: there is no value.
    Missing,
}

impl Column {
    /// A column of words.
    pub fn words(name: &str, heading: &str) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), holds: Holds::Words }
    }

    /// A column of numbers.
    pub fn numbers(name: &str, heading: &str, measure: Measure) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), holds: Holds::Numbers(measure) }
    }

    /// A column of intervals.
    pub fn intervals(name: &str, heading: &str, measure: Measure) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), holds: Holds::Intervals(measure) }
    }

    /// A column of drawings that programs do not get.
    pub fn drawings(name: &str, heading: &str) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), holds: Holds::Drawings }
    }

    /// What its numbers measure.
    fn measure(&self) -> Option<Measure> {
        match self.holds {
            Holds::Words | Holds::Drawings => None,
            Holds::Numbers(measure) | Holds::Intervals(measure) => Some(measure),
        }
    }
}

/// Returns the name of a column for programs: the letters and digits of a text in lower case, with underscores between its words.
pub fn column_name(text: &str) -> String {
    let words = text.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_").to_lowercase()
}

impl Measure {
    /// Its name for programs.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Dollars => "dollars",
            Measure::Count => "count",
            Measure::Days => "days",
            Measure::Share => "share",
            Measure::Millions => "millions of dollars",
            Measure::Number(_) => "number",
        }
    }

    /// A value as people read it.
    pub fn written(self, value: f64) -> String {
        match self {
            _ if !value.is_finite() => MISSING.to_owned(),
            Measure::Dollars => dollars(value),
            Measure::Count | Measure::Days => grouped(value + 0.0, 0),
            Measure::Share => percent(value, 1),
            Measure::Millions => grouped(value + 0.0, 1),
            Measure::Number(decimals) => grouped(value + 0.0, decimals),
        }
    }

    /// The same in few letters.
    fn short(self, value: f64) -> String {
        match self {
            Measure::Dollars if value.is_finite() && value.abs() >= 100_000.0 => short_dollars(value),
            _ => self.written(value),
        }
    }
}

/// What stands where there is no value.
const MISSING: &str = "–";

impl Datum {
    /// Words.
    pub fn words(text: impl Into<String>) -> Datum {
        Datum::Words(text.into())
    }

    /// A number, if there is one.
    pub fn number(value: impl Into<Option<f64>>) -> Datum {
        value.into().filter(|value| value.is_finite()).map_or(Datum::Missing, Datum::Number)
    }

    /// An interval, if there is one.
    pub fn interval(interval: Option<Interval>) -> Datum {
        interval.map_or(Datum::Missing, Datum::Interval)
    }

    fn written(&self, measure: Option<Measure>, is_short: bool) -> String {
        let own = measure.unwrap_or(Measure::Number(2));
        let write = |value: f64, measure: Measure| match is_short {
            true => measure.short(value),
            false => measure.written(value),
        };
        match self {
            Datum::Words(text) => text.clone(),
            Datum::Number(value) => write(*value, own),
            Datum::Measured(value, measure) => write(*value, *measure),
            Datum::Interval(Interval { low, high }) => {
                format!("{} to {}", write(*low, own), write(*high, own))
            }
            Datum::Missing => MISSING.to_owned(),
        }
    }
}

impl Exhibit {
    /// With one table.
    pub fn of(title: impl Into<String>, table: Tabulation) -> Exhibit {
        Exhibit { title: title.into(), tables: vec![table], graphs: Vec::new(), notes: Vec::new() }
    }

    /// The same with a note.
    pub fn with_note(mut self, note: impl Into<String>) -> Exhibit {
        self.notes.push(note.into());
        self
    }
}

impl Tabulation {
    /// Without rows yet.
    pub fn new(name: &str, caption: impl Into<String>, columns: Vec<Column>) -> Tabulation {
        Tabulation {
            name: name.to_owned(),
            caption: caption.into(),
            columns,
            rows: Vec::new(),
            summary: Vec::new(),
            is_for_programs: false,
        }
    }
}

#[cfg(test)]
mod tests;
