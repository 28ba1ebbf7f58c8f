//! Asking the database.

use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::{Map, Value, json};

use crate::resume::integrity::is_as_left;
use crate::resume::sealing::SealKey;
use crate::state::Session;
use novamind_base::notation::json_number;
use novamind_database::query::{Limits, SQL_CANCELLED};
use novamind_database::{
    Cell, Interrupt, Location, QueryConnection, QueryError, Rows, Scope, Ticket, query_connection,
};
use novamind_record::error::RunError;
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::{Query, QuerySource};
use novamind_tools::Refusal;

impl Session {
    /// Answers one guarded statement and records that it was asked.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub fn query(&mut self, sql: &str) -> Result<Rows, Refusal> {
        self.query_of(sql, QuerySource::Typed)
    }

    /// The same for a statement that came from somewhere else.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub fn query_of(&mut self, sql: &str, via: QuerySource) -> Result<Rows, Refusal> {
        match self.interrupt() {
            Ok(interrupt) => self.query_as(interrupt.ticket(), sql, via),
            Err(refusal) => {
                self.note_query(sql, Err(&refusal), Duration::ZERO, via);
                Err(refusal)
            }
        }
    }

    /// The same under a ticket of [`Session::interrupt`] that was drawn when the statement was asked for.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub fn query_as(&mut self, ticket: Ticket, sql: &str, via: QuerySource) -> Result<Rows, Refusal> {
        let started = Instant::now();
        let answer = self.answer_within(ticket, sql, limits(self));
        self.note_query(sql, answer.as_ref(), started.elapsed(), via);
        answer
    }

    /// Answers a statement under these limits, and leaves recording it to the caller.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub(crate) fn answer_within(
        &mut self,
        ticket: Ticket,
        sql: &str,
        limits: Limits,
    ) -> Result<Rows, Refusal> {
        let answer = self
            .connection()
            .and_then(|connection| connection.ask_as(ticket, sql, limits).map_err(query_refusal));
        answer.map_err(
            |refusal| {
                if self.may_look_inside() { with_the_way_to_hidden_tables(refusal) } else { refusal }
            },
        )
    }

    /// Answers a statement of the program's own, which is not recorded: what a person did not ask.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub fn look_into_database(&mut self, sql: &str) -> Result<Rows, Refusal> {
        let ticket = self.interrupt()?.ticket();
        let limits = limits(self);
        self.connection().and_then(|connection| connection.ask_as(ticket, sql, limits).map_err(query_refusal))
    }

    /// A handle that stops the running query.
    ///
    /// # Errors
    /// The run has no database.
    pub fn interrupt(&mut self) -> Result<Interrupt, Refusal> {
        self.connection().map(|connection| connection.interrupt())
    }

    /// A connection of its own, for a thread that asks while the session works. What it asks is recorded with
    /// [`Session::note_query`].
    ///
    /// # Errors
    /// The run has no database, or it cannot be read.
    pub fn open_connection(&self) -> Result<QueryConnection, Refusal> {
        self.projection.open_connection(Scope::Visible)
    }

    /// Waits until the database holds everything up to the last decision day and this week's calls.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn wait_for_database(&self) -> Result<(), Refusal> {
        let refused = |problem: String| Refusal::new("sql_error", problem);
        if let Some(recorder) = self.recorder.as_ref().filter(|recorder| !recorder.syncs_calls()) {
            recorder.sync_calls().map_err(|error| refused(error.to_string()))?;
            self.commit_projection();
        }
        self.projection.wait().map_err(|error| refused(error.to_string()))
    }

    /// Limits of a query in this run.
    pub fn query_limits(&self) -> Limits {
        limits(self)
    }

    /// Records a query that was asked elsewhere.
    pub fn note_query(
        &mut self,
        sql: &str,
        answer: Result<&Rows, &Refusal>,
        took: Duration,
        via: QuerySource,
    ) {
        let rows = answer.ok();
        let refusal = answer.err();
        let query = Query {
            sql: sql.to_owned(),
            rows: rows.map(|rows| rows.rows.len() as u64),
            truncated: rows.is_some_and(|rows| rows.truncated),
            error: refusal.map(|refusal| refusal.code.to_owned()),
            message: refusal.map(|refusal| refusal.message.clone()),
            stopped: refusal.is_some_and(|refusal| refusal.code == SQL_CANCELLED),
            via: Some(via),
            took_ms: (took.as_secs_f64() * 1e6).round() / 1e3,
        };
        self.remember_query(&query);
        self.note(Record::Query(query));
    }

    /// The last statements the database was asked in this run, each once, the newest last.
    pub fn asked(&self) -> &[String] {
        &self.history.asked
    }

    /// Keeps a statement for whoever asks again; those of scripts stand in their code.
    pub(super) fn remember_query(&mut self, Query { sql, via, .. }: &Query) {
        const KEPT: usize = 100;
        if *via == Some(QuerySource::Script) {
            return;
        }
        self.history.asked.retain(|known| known != sql);
        self.history.asked.push(sql.clone());
        let surplus = self.history.asked.len().saturating_sub(KEPT);
        self.history.asked.drain(..surplus);
    }

    /// The connection of this thread, to a database that holds everything up to now.
    pub(super) fn connection(&mut self) -> Result<&QueryConnection, Refusal> {
        self.complete_database()?;
        self.projection.connection()
    }

    /// Waits until the database holds everything up to now, and mends it where it could not be written.
    pub fn complete_database(&mut self) -> Result<(), Refusal> {
        let Err(problem) = self.wait_for_database() else { return Ok(()) };
        // There may be room again.
        self.mend_database().map_err(|_| problem)
    }
}

fn limits(session: &Session) -> Limits {
    let own = &session.params().limits;
    Limits {
        rows: own.query_row_limit as usize,
        time: Duration::from_secs(u64::from(own.query_timeout_seconds)),
        steps: None,
    }
}

/// Converts the error of a query into the refusal that the caller of a tool receives.
pub fn query_refusal(error: QueryError) -> Refusal {
    let message = match error.position {
        Some(at) => format!("{} (at character {})", error.message, at + 1),
        None => error.message,
    };
    Refusal::new(error.code, message)
}

/// The refusal for a record that cannot be read.
pub fn not_readable(error: &RunError) -> Refusal {
    Refusal::new("not_readable", error.to_string())
}

/// A connection to the database file of a run as it stands, and the line of the trajectory that it stands at. The key is
/// that of the run's snapshots.
///
/// # Errors
/// The file is missing, no database of a run, or not the one that the program left when the run was closed.
pub fn connection_to_file(
    folder: &Path,
    key: &SealKey,
) -> Result<(QueryConnection, novamind_database::Position), Refusal> {
    if !is_as_left(folder, key) {
        return Err(Refusal::new("sql_error", "world.db was changed after the run was closed"));
    }
    query_connection(&Location::File(folder.join("world.db")), Scope::Visible)
        .map_err(|error| Refusal::new("sql_error", error.to_string()))
}

/// Names of columns, each once: the second `n` is `n:2`.
fn unique_names(columns: &[String]) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(columns.len());
    for column in columns {
        let numbered = (2..).map(|number| format!("{column}:{number}"));
        let mut free = std::iter::once(column.clone()).chain(numbered).filter(|name| !names.contains(name));
        names.extend(free.next());
    }
    names
}

/// A result as programs get it: rows as objects; of equal column names the second is `name:2`.
pub fn rows_as_json(rows: &Rows) -> Map<String, Value> {
    let columns = unique_names(&rows.columns);
    let object = |row: &Vec<Cell>| {
        let fields = columns.iter().zip(row).map(|(column, cell)| (column.clone(), cell_as_json(cell)));
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

/// A value as JSON; numbers that JSON cannot hold become null.
pub fn cell_as_json(cell: &Cell) -> Value {
    match cell {
        Cell::Null => Value::Null,
        Cell::Integer(number) => (*number).into(),
        Cell::Real(number) if number.fract() == 0.0 => json!(number),
        Cell::Real(number) => json_number(*number),
        Cell::Text(text) => text.clone().into(),
    }
}

/// What is said of a hidden table where the run may be looked into: it is there, and asked otherwise. Elsewhere nobody learns
/// that there is such a table.
pub fn with_the_way_to_hidden_tables(refusal: Refusal) -> Refusal {
    let named = refusal.message.strip_prefix("there is no table hidden.");
    let Some(name) = named.and_then(|rest| rest.split(';').next()) else { return refusal };
    let message = format!(
        "hidden.{name} is not among the visible tables; hidden tables are asked with novamind query --xray, and with \
         xray sql in plain mode"
    );
    Refusal { message, ..refusal }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_equal_names_are_all_kept() {
        let columns = ["n", "n", "day", "n", "n:2"].map(str::to_owned).to_vec();
        let rows = Rows { columns, rows: vec![(1..=5).map(Cell::Integer).collect()], ..Rows::default() };
        let data = rows_as_json(&rows);
        assert_eq!(data["columns"], json!(["n", "n:2", "day", "n:3", "n:2:2"]));
        assert_eq!(data["rows"], json!([{ "n": 1, "n:2": 2, "day": 3, "n:3": 4, "n:2:2": 5 }]));
    }
}
