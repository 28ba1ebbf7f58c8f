//! The hidden tables of the x-ray: ordinary tables in memory that belongs to one connection, under a schema of their own
//! (docs/formats/hidden-tables.md). Nothing of them is in any file.

use rusqlite::Connection;

use super::catalogue::{HIDDEN_SCHEMA, Table, hidden_tables};

/// A value of a hidden table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HiddenValue {
    /// There is none.
    Null,
    /// A whole number; truth values are 0 and 1.
    Whole(i64),
    /// A number.
    Real(f64),
    /// A word of a fixed list.
    Word(&'static str),
}

impl From<u32> for HiddenValue {
    fn from(number: u32) -> Self {
        HiddenValue::Whole(number.into())
    }
}

impl From<bool> for HiddenValue {
    fn from(holds: bool) -> Self {
        HiddenValue::Whole(holds.into())
    }
}

impl From<f64> for HiddenValue {
    fn from(number: f64) -> Self {
        HiddenValue::Real(number)
    }
}

impl From<&'static str> for HiddenValue {
    fn from(word: &'static str) -> Self {
        HiddenValue::Word(word)
    }
}

impl<T: Into<HiddenValue>> From<Option<T>> for HiddenValue {
    fn from(value: Option<T>) -> Self {
        value.map_or(HiddenValue::Null, Into::into)
    }
}

/// Declares the tables, empty, beside those of a connection.
pub(super) fn attach(connection: &Connection) -> rusqlite::Result<()> {
    // A connection that only reads could write to no memory that is attached as `:memory:`.
    connection.execute_batch(&format!("ATTACH 'file:{HIDDEN_SCHEMA}?mode=memory' AS {HIDDEN_SCHEMA}"))?;
    let declarations: Vec<String> = hidden_tables().iter().map(Table::declaration).collect();
    connection.execute_batch(&declarations.join(";\n"))
}
