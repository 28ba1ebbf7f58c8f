//! Fills the hidden tables of a connection.

use std::time::Duration;

use rusqlite::Connection;

use super::catalogue::{Table, hidden_tables};
use super::hidden_schema::HiddenValue;
use super::query::{QueryConnection, QueryError, QueryFault, QueryLimits};
use super::query_interrupt::QueryTicket;
use super::rows::{NULL, Value, insert_rows, integer, real, text};

const MAX_FILL_TIME: Duration = Duration::from_secs(600);

impl QueryConnection {
    /// Returns the hidden tables that statements name, without duplicates. If a statement does not compile, returns
    /// only the tables of the statements before the error.
    pub fn hidden_tables_in(&self, sql: &str) -> Vec<&'static Table> {
        let spelled = self.released.spell(sql);
        let mut statements = self.released.statements(sql, &spelled);
        let mut named = Vec::new();
        while let Ok(Some(reading)) = statements.next() {
            named.extend(reading.tables);
        }
        hidden_tables().iter().filter(|table| named.contains(&table.name)).collect()
    }

    /// Writes rows to a hidden table atomically. Replaces the existing rows if `replaces_rows` is true, otherwise
    /// appends rows.
    ///
    /// # Errors
    /// `sql_cancelled` if the user cancelled the query, `sql_timeout` if filling took too much time or memory,
    /// otherwise `sql_error`.
    pub fn fill_hidden_table<const COLUMNS: usize>(
        &self,
        ticket: QueryTicket,
        table: &Table,
        replaces_rows: bool,
        rows: impl Iterator<Item = [HiddenValue; COLUMNS]>,
    ) -> Result<(), QueryError> {
        self.interrupt.begin(ticket, MAX_FILL_TIME, None);
        let write = |connection: &Connection| {
            let transaction = connection.unchecked_transaction()?;
            if replaces_rows {
                transaction.execute(&format!("DELETE FROM {}", table.name), [])?;
            }
            let rows = rows.map(|row| row.map(to_sql_value));
            insert_rows(&transaction, &format!("INSERT INTO {} VALUES", table.name), rows)?;
            transaction.commit()
        };
        let written = self.with_trust(|connection| {
            connection.pragma_update(None, "query_only", false)?;
            let written = write(connection);
            connection.pragma_update(None, "query_only", true)?;
            written
        });
        let limits = QueryLimits { rows: 0, time: MAX_FILL_TIME, steps: None };
        written.map_err(|error| self.fault_to_error("", QueryFault::Sqlite(error), limits))
    }
}

fn to_sql_value(value: HiddenValue) -> Value<'static> {
    match value {
        HiddenValue::Null => NULL,
        HiddenValue::Integer(number) => integer(number),
        HiddenValue::Real(number) => real(number),
        HiddenValue::Text(word) => text(word),
    }
}
