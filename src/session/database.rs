//! The database of a run: a background writer for entries, a connection for queries, and query results as JSON.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Map, Value, json};

use novamind_base::formatting::json_number;
use novamind_database::query::QueryLimits;
use novamind_database::{
    Cell, DatabaseLocation, Interrupt, ProjectionEntry, ProjectionError, ProjectionPosition, Projector,
    QueryConnection, QueryError, QueryResult, QueryTicket, Scope, export_sqlite, query_connection,
};
use novamind_record::error::RunError;
use novamind_tools::Rejection;
use novamind_world::events::Facts;
use novamind_world::params::Interface;

/// The database of a run. A run without a database discards entries and rejects queries.
#[derive(Default)]
pub struct RunDatabase {
    projector: Option<Projector>,
    /// Complete database file of an ended run, which is only read.
    finished_file: Option<(DatabaseLocation, Interface)>,
    /// Query connection of the session; opened for the first query.
    connection: Option<QueryConnection>,
    /// Number of times the database was replaced since the run was opened.
    replacement_count: u32,
}

impl RunDatabase {
    pub(crate) fn new(projector: Option<Projector>) -> RunDatabase {
        RunDatabase { projector, ..RunDatabase::default() }
    }

    /// Opens the database file of an ended run. `interface` is the interface of the release that the tables follow.
    pub(crate) fn from_file(location: DatabaseLocation, interface: Interface) -> RunDatabase {
        RunDatabase { finished_file: Some((location, interface)), ..RunDatabase::default() }
    }

    /// Returns a handle that writes entries to the database.
    pub fn entry_writer(&self) -> EntryWriter<'_> {
        EntryWriter(self.projector.as_ref())
    }

    /// Makes all entries up to a line visible to queries.
    pub(crate) fn commit(&self, position: &ProjectionPosition) {
        if let Some(projector) = &self.projector {
            projector.commit(position.clone());
        }
    }

    pub(crate) fn wait_until_written(&self) -> Result<(), ProjectionError> {
        self.projector.as_ref().map_or(Ok(()), Projector::flush)
    }

    /// Calls `work` after all pending entries are written. Passes the digest of the file if `digest` is true. If the
    /// run has no database, calls `work` immediately.
    pub(crate) fn after_writes(&self, digest: bool, work: impl FnOnce(Option<String>) + Send + 'static) {
        match &self.projector {
            Some(projector) => projector.run_after_commit(digest, work),
            None => work(None),
        }
    }

    /// Returns the error that prevents writing the database, if any.
    pub fn failure(&self) -> Option<ProjectionError> {
        self.projector.as_ref()?.failure()
    }

    pub(crate) fn replace(&mut self, replacement: RunDatabase) {
        *self = RunDatabase { replacement_count: self.replacement_count + 1, ..replacement };
    }

    /// Returns the number of times that the database was replaced since the run was opened. Connections to an earlier
    /// database are stale.
    pub fn replacement_count(&self) -> u32 {
        self.replacement_count
    }

    /// Opens a separate connection for a thread that runs queries in parallel with the session. The thread records its
    /// queries with [`Session::record_query`](crate::Session::record_query).
    ///
    /// # Errors
    /// The run has no database, or the database cannot be read.
    pub fn open_connection(&self) -> Result<QueryConnection, Rejection> {
        self.open_scoped_connection(Scope::Visible)
    }

    pub(crate) fn open_scoped_connection(&self, scope: Scope) -> Result<QueryConnection, Rejection> {
        let connection = match (&self.projector, &self.finished_file) {
            (Some(projector), _) => projector.connection(scope),
            (None, Some((location, interface))) => {
                query_connection(location, *interface, scope).map(|(connection, _)| connection)
            }
            (None, None) => return Err(Rejection::new("sql_error", "this run has no database")),
        };
        connection.map_err(|error| Rejection::new("sql_error", error.to_string()))
    }

    /// Returns the query connection of the session.
    ///
    /// # Errors
    /// The run has no database, or the database cannot be read.
    pub(crate) fn connection(&mut self) -> Result<&QueryConnection, Rejection> {
        let connection = match self.connection.take() {
            Some(connection) => connection,
            None => self.open_connection()?,
        };
        Ok(self.connection.insert(connection))
    }

    /// Returns a handle that stops the running query.
    ///
    /// # Errors
    /// The run has no database.
    pub fn interrupt_handle(&mut self) -> Result<Interrupt, Rejection> {
        self.connection().map(QueryConnection::interrupt)
    }

    pub(crate) fn query(
        &mut self,
        ticket: QueryTicket,
        sql: &str,
        limits: QueryLimits,
    ) -> Result<QueryResult, Rejection> {
        self.connection()?.query_with_ticket(ticket, sql, limits).map_err(query_rejection)
    }

    /// Copies the tables into a new file that any SQLite tool can open.
    ///
    /// # Errors
    /// The run has no database, or the file cannot be written.
    pub(crate) fn copy_to(&self, file: &Path) -> Result<(), RunError> {
        match (&self.projector, &self.finished_file) {
            (Some(projector), _) => Ok(projector.export_sqlite(file)?),
            (None, Some((location, interface))) => Ok(export_sqlite(location, *interface, file)?),
            (None, None) => Err(RunError::InvalidRequest("this run has no database".to_owned())),
        }
    }

    #[cfg(test)]
    pub(crate) fn limit_pages(&self, more: Option<u32>) {
        self.projector.as_ref().expect("a database").limit_pages(more);
    }
}

/// A handle that sends entries to the database from any thread.
#[derive(Clone, Copy)]
pub struct EntryWriter<'a>(Option<&'a Projector>);

impl EntryWriter<'_> {
    /// Sends an entry to the database. If the run has no database, the entry is not created.
    pub(crate) fn send(self, entry: impl FnOnce() -> ProjectionEntry) {
        if let Some(projector) = self.0 {
            projector.enqueue(entry());
        }
    }

    /// Returns facts that the database writer no longer needs, so that their memory can be reused.
    pub(crate) fn spare_facts(self) -> Option<Arc<Facts>> {
        self.0?.spare_facts()
    }
}

/// Converts the error of a query to a rejection.
pub fn query_rejection(error: QueryError) -> Rejection {
    let message = match error.position {
        Some(at) => format!("{} (at character {})", error.message, at + 1),
        None => error.message,
    };
    Rejection::new(error.code, message)
}

/// Returns the rejection for a record that cannot be read.
pub fn unreadable_record_rejection(error: &RunError) -> Rejection {
    Rejection::new("not_readable", error.to_string())
}

/// Makes column names unique: the second `n` becomes `n:2`.
fn unique_names(columns: &[String]) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(columns.len());
    for column in columns {
        let numbered = (2..).map(|number| format!("{column}:{number}"));
        let mut free = std::iter::once(column.clone()).chain(numbered).filter(|name| !names.contains(name));
        names.extend(free.next());
    }
    names
}

/// Converts a query result to JSON for programs: rows are objects, and column names are unique.
pub fn rows_to_json(rows: &QueryResult) -> Map<String, Value> {
    let columns = unique_names(&rows.columns);
    let object = |row: &Vec<Cell>| {
        let fields = columns.iter().zip(row).map(|(column, cell)| (column.clone(), cell_to_json(cell)));
        Value::Object(fields.collect())
    };
    let mut data = Map::from_iter([
        ("columns".to_owned(), json!(columns)),
        ("rows".to_owned(), rows.rows.iter().map(object).collect()),
        ("row_count".to_owned(), rows.rows.len().into()),
    ]);
    if rows.truncated {
        data.insert("truncated".to_owned(), true.into());
    }
    if let Some(warning) = &rows.warning {
        data.insert("warning".to_owned(), warning.clone().into());
    }
    if let Some(hint) = &rows.hint {
        data.insert("hint".to_owned(), hint.clone().into());
    }
    data
}

/// Converts a cell to JSON; non-finite numbers become null.
fn cell_to_json(cell: &Cell) -> Value {
    match cell {
        Cell::Null => Value::Null,
        Cell::Integer(number) => (*number).into(),
        Cell::Real(number) if number.fract() == 0.0 => json!(number),
        Cell::Real(number) => json_number(*number),
        Cell::Text(text) => text.clone().into(),
    }
}

/// Replaces the message about a missing hidden table with a hint on how to query hidden tables. Callers use the hint
/// only if the run can be inspected. Otherwise, the message must not reveal that the table exists.
pub fn with_hidden_table_hint(rejection: Rejection) -> Rejection {
    let named = rejection.message.strip_prefix("there is no table hidden.");
    let Some(name) = named.and_then(|rest| rest.split(';').next()) else { return rejection };
    let message = format!(
        "hidden.{name} is not a visible table; query hidden tables with novamind query --xray, or with xray sql in \
         plain mode"
    );
    Rejection { message, ..rejection }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn duplicate_column_names_are_numbered() {
        let columns = ["n", "n", "day", "n", "n:2"].map(str::to_owned).to_vec();
        let rows = QueryResult {
            columns,
            rows: vec![(1..=5).map(Cell::Integer).collect()],
            ..QueryResult::default()
        };
        let data = rows_to_json(&rows);
        assert_eq!(data["columns"], json!(["n", "n:2", "day", "n:3", "n:2:2"]));
        assert_eq!(data["rows"], json!([{ "n": 1, "n:2": 2, "day": 3, "n:3": 4, "n:2:2": 5 }]));
    }
}
