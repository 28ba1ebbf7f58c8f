//! Filling the hidden tables of a connection.

use std::time::Duration;

use rusqlite::Connection;

use super::catalogue::{Table, hidden_tables};
use super::hidden::HiddenValue;
use super::interrupt::Ticket;
use super::query::{Fault, Limits, QueryConnection, QueryError};
use super::rows::{NOTHING, Value, insert_rows, real, text, whole};

const LONGEST: Duration = Duration::from_secs(600);

impl QueryConnection {
    /// Returns the hidden tables that statements name, each once. For a text that does not compile, returns those before the error.
    pub fn hidden_tables_in(&self, sql: &str) -> Vec<&'static Table> {
        let mut statements = self.released.statements(sql);
        let mut named = Vec::new();
        while let Ok(Some(reading)) = statements.next() {
            named.extend(reading.tables);
        }
        hidden_tables().iter().filter(|table| named.contains(&table.name)).collect()
    }

    /// Writes rows to a hidden table atomically, replacing its rows if `anew` is set, or else appending.
    ///
    /// # Errors
    /// `sql_cancelled` if the user cancelled it, `sql_timeout` if it took too much time or memory, `sql_error`.
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

fn bound(value: HiddenValue) -> Value<'static> {
    match value {
        HiddenValue::Null => NOTHING,
        HiddenValue::Whole(number) => whole(number),
        HiddenValue::Real(number) => real(number),
        HiddenValue::Word(word) => text(word),
    }
}
