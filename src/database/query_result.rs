//! Results of SQL queries.

use rusqlite::types::ValueRef;

/// A value in a query result.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// SQL NULL.
    Null,
    /// An SQL integer.
    Integer(i64),
    /// An SQL floating-point number.
    Real(f64),
    /// SQL text, or a blob converted to text.
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

/// The rows that a query returned.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct QueryResult {
    /// Names of the columns. Several columns may have the same name.
    pub columns: Vec<String>,
    /// Rows, each with one cell per column.
    pub rows: Vec<Vec<Cell>>,
    /// Whether more rows exist than were returned.
    pub truncated: bool,
    /// Warning that the result is truncated; otherwise `None`.
    pub warning: Option<String>,
    /// Possible reason why the result is empty, if one was found.
    pub hint: Option<String>,
}

/// Returns the number in a cell of a row, or 0 if the cell does not contain a number.
pub fn number_at(row: &[Cell], at: usize) -> f64 {
    match row.get(at) {
        Some(Cell::Integer(number)) => *number as f64,
        Some(Cell::Real(number)) => *number,
        _ => 0.0,
    }
}

/// Returns the text in a cell of a row, or an empty text if the cell does not contain text.
pub fn text_at(row: &[Cell], at: usize) -> &str {
    match row.get(at) {
        Some(Cell::Text(text)) => text,
        _ => "",
    }
}
