//! Reports of laboratory commands: tables of typed cells, graphs and notes.
//!
//! A report is written as terminal text ([`LabReport::to_text`]), comma-separated values
//! ([`LabTable::to_csv_rows`]), JSON ([`LabReport::to_json`]) and SVG ([`LabReport::to_svg`]). CSV, JSON and SVG have
//! full precision.

mod data;
mod graph;
mod text;

pub use graph::{Graph, GraphAxis, GraphForm, Series};
pub use novamind_report::plot::AxisScale;

use novamind_base::formatting::{dollars, grouped_number, percent, short_dollars};
use novamind_base::statistics::Interval;

/// Default maximum width of a table, in terminal columns.
pub const DEFAULT_WIDTH: usize = 100;

/// The report of a laboratory command.
#[derive(Debug, Clone, PartialEq)]
pub struct LabReport {
    /// Title of the report, which precedes the tables.
    pub title: String,
    /// Tables of the report; the first table contains the main result.
    pub tables: Vec<LabTable>,
    /// Graphs of the report, shown below the tables.
    pub graphs: Vec<Graph>,
    /// Notes below the tables: assumptions, definitions and sources.
    pub notes: Vec<String>,
}

/// A table of a report.
#[derive(Debug, Clone, PartialEq)]
pub struct LabTable {
    /// Name that exports and `--table NAME` use.
    pub name: String,
    /// Caption of the table; can be empty.
    pub caption: String,
    /// Columns of the table, from left to right.
    pub columns: Vec<Column>,
    /// Cells of each row, one per column.
    pub rows: Vec<Vec<CellValue>>,
    /// Summary rows. In text, a horizontal line precedes them. In JSON, they are separate from the other rows.
    pub summary: Vec<Vec<CellValue>>,
    /// Whether the table is too long for text, which then contains only the option that exports the table.
    pub is_machine_readable_only: bool,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Name that exports use; see [`column_name`].
    pub name: String,
    /// Heading of the column, which can wrap at spaces.
    pub heading: String,
    /// Kind of the cells in the column.
    pub kind: ColumnKind,
}

/// The kind of the cells in a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// Texts, which are left-aligned.
    Text,
    /// Numbers, which are right-aligned.
    Number(Measure),
    /// Intervals, exported as two numbers.
    Interval(Measure),
    /// Character drawings, which are not exported.
    Sparkline,
}

/// A measure: the unit and the display format of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// An amount in dollars.
    Dollars,
    /// A number of items.
    Count,
    /// A duration in days.
    Days,
    /// A share from 0 to 1, shown in percent.
    Share,
    /// Millions of dollars, shown with one decimal.
    Millions,
    /// Any other number, shown with the given number of decimals.
    Number(usize),
}

/// The content of a cell.
#[derive(Debug, Clone, PartialEq)]
pub enum CellValue {
    /// A text.
    Text(String),
    /// A number in the unit of the column.
    Number(f64),
    /// A number with its own unit, for tables whose rows have different units.
    NumberWithMeasure(f64, Measure),
    /// An interval in the measure of the column.
    Interval(Interval),
    /// A missing value.
    Missing,
}

impl Column {
    /// Creates a text column.
    pub fn text(name: &str, heading: &str) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), kind: ColumnKind::Text }
    }

    /// Creates a number column.
    pub fn number(name: &str, heading: &str, measure: Measure) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), kind: ColumnKind::Number(measure) }
    }

    /// Creates an interval column.
    pub fn interval(name: &str, heading: &str, measure: Measure) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), kind: ColumnKind::Interval(measure) }
    }

    /// Creates a column of character drawings, which is not exported.
    pub fn sparkline(name: &str, heading: &str) -> Column {
        Column { name: name.to_owned(), heading: heading.to_owned(), kind: ColumnKind::Sparkline }
    }

    /// Returns the measure of the column's numbers, or `None` for other columns.
    fn measure(&self) -> Option<Measure> {
        match self.kind {
            ColumnKind::Text | ColumnKind::Sparkline => None,
            ColumnKind::Number(measure) | ColumnKind::Interval(measure) => Some(measure),
        }
    }
}

/// Returns a column name for exports: the letters and digits of `text` in lower case, with underscores between the
/// words.
pub fn column_name(text: &str) -> String {
    let words = text.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_").to_lowercase()
}

impl Measure {
    /// Returns the name that exports use for the measure.
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

    /// Formats a value with the unit and decimals of the measure.
    pub fn format(self, value: f64) -> String {
        match self {
            _ if !value.is_finite() => MISSING_VALUE.to_owned(),
            Measure::Dollars => dollars(value),
            Measure::Count | Measure::Days => grouped_number(value + 0.0, 0),
            Measure::Share => percent(value, 1),
            Measure::Millions => grouped_number(value + 0.0, 1),
            Measure::Number(decimals) => grouped_number(value + 0.0, decimals),
        }
    }

    /// Formats a value of the measure with as few characters as possible.
    fn format_short(self, value: f64) -> String {
        match self {
            Measure::Dollars if value.is_finite() && value.abs() >= 100_000.0 => short_dollars(value),
            _ => self.format(value),
        }
    }
}

const MISSING_VALUE: &str = "–";

impl CellValue {
    /// Creates a text cell.
    pub fn text(text: impl Into<String>) -> CellValue {
        CellValue::Text(text.into())
    }

    /// Creates a number cell, or a missing value for `None`.
    pub fn number(value: impl Into<Option<f64>>) -> CellValue {
        value.into().filter(|value| value.is_finite()).map_or(CellValue::Missing, CellValue::Number)
    }

    /// Creates an interval cell, or a missing value for `None`.
    pub fn interval(interval: Option<Interval>) -> CellValue {
        interval.map_or(CellValue::Missing, CellValue::Interval)
    }

    fn format(&self, measure: Option<Measure>, is_short: bool) -> String {
        let measure = measure.unwrap_or(Measure::Number(2));
        let write = |value: f64, measure: Measure| match is_short {
            true => measure.format_short(value),
            false => measure.format(value),
        };
        match self {
            CellValue::Text(text) => text.clone(),
            CellValue::Number(value) => write(*value, measure),
            CellValue::NumberWithMeasure(value, measure) => write(*value, *measure),
            CellValue::Interval(Interval { low, high }) => {
                format!("{} to {}", write(*low, measure), write(*high, measure))
            }
            CellValue::Missing => MISSING_VALUE.to_owned(),
        }
    }
}

impl LabReport {
    /// Creates a report with one table.
    pub fn with_table(title: impl Into<String>, table: LabTable) -> LabReport {
        LabReport { title: title.into(), tables: vec![table], graphs: Vec::new(), notes: Vec::new() }
    }

    /// Adds a note to the report.
    pub fn with_note(mut self, note: impl Into<String>) -> LabReport {
        self.notes.push(note.into());
        self
    }
}

impl LabTable {
    /// Creates a table without rows.
    pub fn new(name: &str, caption: impl Into<String>, columns: Vec<Column>) -> LabTable {
        LabTable {
            name: name.to_owned(),
            caption: caption.into(),
            columns,
            rows: Vec::new(),
            summary: Vec::new(),
            is_machine_readable_only: false,
        }
    }
}

#[cfg(test)]
mod tests;
