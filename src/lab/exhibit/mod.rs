//! Output of laboratory commands: tables of typed cells, graphs, and notes.
//!
//! An exhibit is written as terminal text ([`Exhibit::as_text`]), comma-separated values ([`Tabulation::as_csv`]), JSON
//! ([`Exhibit::as_json`]) and SVG ([`Exhibit::as_svg`]). The last three have full precision.

mod data;
mod graph;
mod text;

pub use graph::{Graph, GraphAxis, GraphForm, Series};
pub use novamind_report::plot::AxisScale;

use novamind_base::notation::{dollars, grouped, percent, short_dollars};
use novamind_base::statistics::Interval;

/// Default maximum width of a table in columns.
pub const WIDTH: usize = 100;

/// The output of a laboratory command.
#[derive(Debug, Clone, PartialEq)]
pub struct Exhibit {
    /// Title.
    pub title: String,
    /// Tables; the first one is the result.
    pub tables: Vec<Tabulation>,
    /// Graphs.
    pub graphs: Vec<Graph>,
    /// Notes below: assumptions, definitions and sources.
    pub notes: Vec<String>,
}

/// A table of an exhibit.
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulation {
    /// Name for programs: `--table NAME` asks for it.
    pub name: String,
    /// Caption; empty for none.
    pub caption: String,
    /// Columns.
    pub columns: Vec<Column>,
    /// Cells by row, one per column.
    pub rows: Vec<Vec<Datum>>,
    /// Summary rows: shown below a rule in text, separate from the rows in JSON.
    pub summary: Vec<Vec<Datum>>,
    /// Whether the table is too long for text, which names the export option instead.
    pub is_for_programs: bool,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Name for programs, see [`column_name`].
    pub name: String,
    /// Heading; it can wrap at spaces.
    pub heading: String,
    /// Cell type.
    pub holds: Holds,
}

/// The cell type of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    /// Text, left-aligned.
    Words,
    /// Numbers, right-aligned.
    Numbers(Measure),
    /// Intervals; two numbers in exports.
    Intervals(Measure),
    /// Character drawings, not exported.
    Drawings,
}

/// The unit and display format of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Dollars.
    Dollars,
    /// A count.
    Count,
    /// Days.
    Days,
    /// A share, 0 to 1; shown in percent.
    Share,
    /// Millions of dollars with one decimal.
    Millions,
    /// Any other number, with this many decimals.
    Number(usize),
}

/// The content of a cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Datum {
    /// Text.
    Words(String),
    /// A number in the column's measure.
    Number(f64),
    /// A number with its own measure, for tables whose rows have different units.
    Measured(f64, Measure),
    /// An interval in the column's measure.
    Interval(Interval),
    /// A missing value.
    Missing,
}

impl Column {
    /// Returns a text column.
    pub fn words(name: &str, heading: &str) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), holds: Holds::Words }
    }

    /// Returns a number column.
    pub fn numbers(name: &str, heading: &str, measure: Measure) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), holds: Holds::Numbers(measure) }
    }

    /// Returns an interval column.
    pub fn intervals(name: &str, heading: &str, measure: Measure) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), holds: Holds::Intervals(measure) }
    }

    /// Returns a column of drawings, which is not exported.
    pub fn drawings(name: &str, heading: &str) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), holds: Holds::Drawings }
    }

    /// Returns the measure of its numbers.
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
    /// Returns the name for programs.
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

    /// Formats a value.
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

    /// Formats a value in few characters.
    fn short(self, value: f64) -> String {
        match self {
            Measure::Dollars if value.is_finite() && value.abs() >= 100_000.0 => short_dollars(value),
            _ => self.written(value),
        }
    }
}

const MISSING: &str = "–";

impl Datum {
    /// Text.
    pub fn words(text: impl Into<String>) -> Datum {
        Datum::Words(text.into())
    }

    /// Returns a number cell, or a missing value.
    pub fn number(value: impl Into<Option<f64>>) -> Datum {
        value.into().filter(|value| value.is_finite()).map_or(Datum::Missing, Datum::Number)
    }

    /// Returns an interval cell, or a missing value.
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
    /// Creates an exhibit with one table.
    pub fn of(title: impl Into<String>, table: Tabulation) -> Exhibit {
        Exhibit { title: title.into(), tables: vec![table], graphs: Vec::new(), notes: Vec::new() }
    }

    /// Adds a note.
    pub fn with_note(mut self, note: impl Into<String>) -> Exhibit {
        self.notes.push(note.into());
        self
    }
}

impl Tabulation {
    /// Creates a table without rows.
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
