//! The hidden tables of the x-ray: ordinary tables in memory that belongs to one connection, under a schema of their own
//! (docs/formats/hidden-tables.md). Whoever has the connection fills them; nothing of them is in any file.

use std::time::Duration;

use rusqlite::Connection;

use super::catalogue::{HIDDEN_SCHEMA, Table, hidden_tables};
use super::interrupt::Ticket;
use super::query::{Fault, Limits, QueryConnection, QueryError};
use super::rows::{NOTHING, Value, insert_rows, real, text, whole};

/// Filling a table takes no longer: a bound for what somebody waits for.
const LONGEST: Duration = Duration::from_secs(600);

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

fn bound(value: HiddenValue) -> Value<'static> {
    match value {
        HiddenValue::Null => NOTHING,
        HiddenValue::Whole(number) => whole(number),
        HiddenValue::Real(number) => real(number),
        HiddenValue::Word(word) => text(word),
    }
}

/// Declares the tables, empty, beside those of a connection.
pub(super) fn attach(connection: &Connection) -> rusqlite::Result<()> {
    // A connection that only reads could write to no memory that is attached as `:memory:`.
    connection.execute_batch(&format!("ATTACH 'file:{HIDDEN_SCHEMA}?mode=memory' AS {HIDDEN_SCHEMA}"))?;
    let declarations: Vec<String> = hidden_tables().iter().map(Table::declaration).collect();
    connection.execute_batch(&declarations.join(";\n"))
}

impl QueryConnection {
    /// The hidden tables that statements name, each once; of a text that does not compile those before the fault.
    pub fn hidden_tables_in(&self, sql: &str) -> Vec<&'static Table> {
        let mut statements = self.released.statements(sql);
        let mut named = Vec::new();
        while let Ok(Some(reading)) = statements.next() {
            named.extend(reading.tables);
        }
        hidden_tables().iter().filter(|table| named.contains(&table.name)).collect()
    }

    /// Writes rows into a hidden table, in place of those it holds or after them. All of them are written, or none.
    ///
    /// # Errors
    /// `sql_timeout`: it was stopped, or memory has run out; `sql_error`.
    pub fn fill_hidden<const COLUMNS: usize>(
        &self,
        ticket: Ticket,
        table: &Table,
        anew: bool,
        rows: impl Iterator<Item = [HiddenValue; COLUMNS]>,
    ) -> Result<(), QueryError> {
        self.interrupt.begin(ticket, LONGEST, None);
        let write = |connection: &Connection| {
            let transaction = connection.unchecked_transaction()?;
            if anew {
                transaction.execute(&format!("DELETE FROM {}", table.name), [])?;
            }
            let rows = rows.map(|row| row.map(bound));
            insert_rows(&transaction, &format!("INSERT INTO {} VALUES", table.name), rows)?;
            transaction.commit()
        };
        let written = self.trusting(|connection| {
            connection.pragma_update(None, "query_only", false)?;
            let written = write(connection);
            connection.pragma_update(None, "query_only", true)?;
            written
        });
        let limits = Limits { rows: 0, time: LONGEST, steps: None };
        written.map_err(|error| self.told("", Fault::Sqlite(error), limits))
    }
}
