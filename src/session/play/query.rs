//! Execution and recording of database queries.

use std::time::{Duration, Instant};

use super::Session;
use crate::database::{RunDatabase, with_hidden_table_hint};
use novamind_database::query::{QueryLimits, SQL_CANCELLED};
use novamind_database::{QueryResult, QueryTicket};
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::{Query, QuerySource};
use novamind_tools::Rejection;

impl Session {
    /// Runs an SQL statement that the user entered, and records the query.
    ///
    /// # Errors
    /// A rejection whose code begins with `sql_`.
    pub fn query(&mut self, sql: &str) -> Result<QueryResult, Rejection> {
        self.query_as(None, sql, QuerySource::Typed)
    }

    /// Runs and records an SQL statement from another source. `ticket` is the ticket that
    /// [`RunDatabase::interrupt_handle`] returned when the query was requested.
    ///
    /// # Errors
    /// A rejection whose code begins with `sql_`.
    pub fn query_as(
        &mut self,
        ticket: Option<QueryTicket>,
        sql: &str,
        via: QuerySource,
    ) -> Result<QueryResult, Rejection> {
        let started = Instant::now();
        let drawn = ticket.map_or_else(|| self.new_ticket(), Ok);
        let answer =
            drawn.and_then(|ticket| self.query_with_limits(ticket, sql, self.company().query_limits()));
        self.record_query(sql, answer.as_ref(), started.elapsed(), via);
        answer
    }

    pub(super) fn new_ticket(&mut self) -> Result<QueryTicket, Rejection> {
        Ok(self.up_to_date_database()?.interrupt_handle()?.issue_ticket())
    }

    /// Runs an SQL statement with these limits. Does not record the query.
    ///
    /// # Errors
    /// A rejection whose code begins with `sql_`.
    pub(crate) fn query_with_limits(
        &mut self,
        ticket: QueryTicket,
        sql: &str,
        limits: QueryLimits,
    ) -> Result<QueryResult, Rejection> {
        let answer = self.up_to_date_database().and_then(|database| database.query(ticket, sql, limits));
        answer.map_err(|rejection| {
            if self.check_inspection().is_ok() { with_hidden_table_hint(rejection) } else { rejection }
        })
    }

    /// Runs an SQL statement of the program. The query is not recorded, because the user did not enter the statement.
    ///
    /// # Errors
    /// A rejection whose code begins with `sql_`.
    pub fn query_unrecorded(&mut self, sql: &str) -> Result<QueryResult, Rejection> {
        let limits = self.company().query_limits();
        let ticket = self.new_ticket()?;
        self.up_to_date_database()?.query(ticket, sql, limits)
    }

    /// Returns the database of the run, in which the newest rows may be missing.
    pub fn database(&self) -> &RunDatabase {
        &self.database
    }

    /// Waits until the database contains all days up to the last decision day and the calls of the current week.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn wait_for_database(&self) -> Result<(), Rejection> {
        let refused = |problem: String| Rejection::new("sql_error", problem);
        if self.log.sync_pending_calls().map_err(|error| refused(error.to_string()))? {
            self.commit_projection();
        }
        self.database.wait_until_written().map_err(|error| refused(error.to_string()))
    }

    /// Records a query that another thread executed.
    pub fn record_query(
        &mut self,
        sql: &str,
        answer: Result<&QueryResult, &Rejection>,
        took: Duration,
        via: QuerySource,
    ) {
        let rows = answer.ok();
        let rejection = answer.err();
        let query = Query {
            sql: sql.to_owned(),
            rows: rows.map(|rows| rows.rows.len() as u64),
            truncated: rows.is_some_and(|rows| rows.truncated),
            error: rejection.map(|rejection| rejection.code.to_owned()),
            message: rejection.map(|rejection| rejection.message.clone()),
            stopped: rejection.is_some_and(|rejection| rejection.code == SQL_CANCELLED),
            via: Some(via),
            took_ms: (took.as_secs_f64() * 1e6).round() / 1e3,
        };
        self.add_to_query_history(&query);
        self.record_event(Record::Query(query));
    }

    /// Adds an SQL statement to the query history, unless a script sent it.
    pub(super) fn add_to_query_history(&mut self, Query { sql, via, .. }: &Query) {
        const MAX_KEPT_QUERIES: usize = 100;
        if *via == Some(QuerySource::Script) {
            return;
        }
        self.history.query_history.retain(|known| known != sql);
        self.history.query_history.push(sql.clone());
        let surplus = self.history.query_history.len().saturating_sub(MAX_KEPT_QUERIES);
        self.history.query_history.drain(..surplus);
    }

    /// Returns the database after all rows are written. Repairs the database if an earlier write failed.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn up_to_date_database(&mut self) -> Result<&mut RunDatabase, Rejection> {
        if let Err(problem) = self.wait_for_database() {
            // Retry the repair, because disk space may be available again.
            self.repair_database().map_err(|_| problem)?;
        }
        Ok(&mut self.database)
    }
}
