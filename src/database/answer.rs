//! What a statement brings: rows of values.

use rusqlite::types::ValueRef;

/// One value of a result.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// SQL NULL.
    Null,
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// Text; blobs arrive as text too.
    Text(String),
}

impl Cell {
    /// A value as the engine hands it out.
    pub(super) fn of(value: ValueRef<'_>) -> Cell {
        match value {
            ValueRef::Null => Cell::Null,
            ValueRef::Integer(number) => Cell::Integer(number),
            ValueRef::Real(number) => Cell::Real(number),
            ValueRef::Text(bytes) | ValueRef::Blob(bytes) => {
                Cell::Text(String::from_utf8_lossy(bytes).into_owned())
            }
        }
    }

    pub(super) fn text_length(&self) -> usize {
        match self {
            Cell::Text(text) => text.len(),
            _ => 0,
        }
    }
}

/// A result.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rows {
    /// Names of the columns; they may repeat.
    pub columns: Vec<String>,
    /// Rows, each with one cell per column.
    pub rows: Vec<Vec<Cell>>,
    /// Whether more rows exist than were fetched.
    pub truncated: bool,
    /// What to know about the result, when it was cut.
    pub warning: Option<String>,
    /// Why an empty result may be empty.
    pub hint: Option<String>,
}

/// A cell of a row as a number; 0 if it holds none.
pub fn number_at(row: &[Cell], at: usize) -> f64 {
    match row.get(at) {
        Some(Cell::Integer(number)) => *number as f64,
        Some(Cell::Real(number)) => *number,
        _ => 0.0,
    }
}

/// A cell of a row as text; empty if it holds none.
pub fn text_at(row: &[Cell], at: usize) -> &str {
    match row.get(at) {
        Some(Cell::Text(text)) => text,
        _ => "",
    }
}
