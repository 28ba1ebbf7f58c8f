//! Results of queries.

use rusqlite::types::ValueRef;

/// A value of a result.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// SQL NULL.
    Null,
    /// An integer.
    Integer(i64),
    /// A floating-point number.
    Real(f64),
    /// Text, or a blob converted to text.
    Text(String),
}

impl Cell {
    pub(super) fn from_sqlite(value: ValueRef<'_>) -> Cell {
        match value {
            ValueRef::Null => Cell::Null,
            ValueRef::Integer(number) => Cell::Integer(number),
            ValueRef::Real(number) => Cell::Real(number),
            ValueRef::Text(bytes) | ValueRef::Blob(bytes) => {
                Cell::Text(String::from_utf8_lossy(bytes).into_owned())
            }
        }
    }

    pub(super) fn text_bytes(&self) -> usize {
        match self {
            Cell::Text(text) => text.len(),
            _ => 0,
        }
    }
}

/// A result.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct QueryResult {
    /// Names of the columns; they may repeat.
    pub columns: Vec<String>,
    /// Rows, each with one cell per column.
    pub rows: Vec<Vec<Cell>>,
    /// Whether more rows exist than were returned.
    pub truncated: bool,
    /// Warning about a truncated result.
    pub warning: Option<String>,
    /// Possible reason of an empty result.
    pub hint: Option<String>,
}

/// Returns a cell of a row as a number, or 0 if it is not one.
pub fn number_at(row: &[Cell], at: usize) -> f64 {
    match row.get(at) {
        Some(Cell::Integer(number)) => *number as f64,
        Some(Cell::Real(number)) => *number,
        _ => 0.0,
    }
}

/// Returns a cell of a row as text, or an empty text if it is not one.
pub fn text_at(row: &[Cell], at: usize) -> &str {
    match row.get(at) {
        Some(Cell::Text(text)) => text,
        _ => "",
    }
}
