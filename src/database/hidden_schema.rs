//! The hidden tables of the x-ray: ordinary tables in the memory of one connection, in a separate schema
//! (docs/formats/hidden-tables.md). The hidden tables are never written to a file.

use rusqlite::Connection;

use super::catalogue::{HIDDEN_SCHEMA, Table, hidden_tables};

/// A value of a hidden table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HiddenValue {
    /// SQL NULL, a missing value.
    Null,
    /// An integer; Booleans are 0 and 1.
    Integer(i64),
    /// A floating-point number.
    Real(f64),
    /// A text from a fixed list.
    Text(&'static str),
}

impl From<u32> for HiddenValue {
    fn from(number: u32) -> Self {
        HiddenValue::Integer(number.into())
    }
}

impl From<bool> for HiddenValue {
    fn from(holds: bool) -> Self {
        HiddenValue::Integer(holds.into())
    }
}

impl From<f64> for HiddenValue {
    fn from(number: f64) -> Self {
        HiddenValue::Real(number)
    }
}

impl From<&'static str> for HiddenValue {
    fn from(word: &'static str) -> Self {
        HiddenValue::Text(word)
    }
}

impl<T: Into<HiddenValue>> From<Option<T>> for HiddenValue {
    fn from(value: Option<T>) -> Self {
        value.map_or(HiddenValue::Null, Into::into)
    }
}

/// Creates the empty hidden tables on a connection.
pub(super) fn create_hidden_tables(connection: &Connection) -> rusqlite::Result<()> {
    // A read-only connection cannot write to a database that is attached as `:memory:`.
    connection.execute_batch(&format!("ATTACH 'file:{HIDDEN_SCHEMA}?mode=memory' AS {HIDDEN_SCHEMA}"))?;
    let declarations: Vec<String> = hidden_tables().iter().map(Table::create_statement).collect();
    connection.execute_batch(&declarations.join(";\n"))
}
