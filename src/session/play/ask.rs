//! Database queries.

use std::time::{Duration, Instant};

use super::Session;
use crate::database::{RunDatabase, with_the_way_to_hidden_tables};
use novamind_database::query::{Limits, SQL_CANCELLED};
use novamind_database::{Rows, Ticket};
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::{Query, QuerySource};
use novamind_tools::Refusal;

impl Session {
    /// Runs a guarded statement and records it.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub fn query(&mut self, sql: &str) -> Result<Rows, Refusal> {
        self.query_as(None, sql, QuerySource::Typed)
    }

    /// Like [`Session::query`], for a statement from another source. `ticket` is the ticket of
    /// [`RunDatabase::interrupt`] that was drawn when the statement was requested.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub fn query_as(&mut self, ticket: Option<Ticket>, sql: &str, via: QuerySource) -> Result<Rows, Refusal> {
        let started = Instant::now();
        let drawn = ticket.map_or_else(|| self.draw_ticket(), Ok);
        let answer = drawn.and_then(|ticket| self.answer_within(ticket, sql, self.company().query_limits()));
        self.note_query(sql, answer.as_ref(), started.elapsed(), via);
        answer
    }

    pub(super) fn draw_ticket(&mut self) -> Result<Ticket, Refusal> {
        Ok(self.complete_database()?.interrupt()?.ticket())
    }

    /// Runs a statement under these limits without recording it.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub(crate) fn answer_within(
        &mut self,
        ticket: Ticket,
        sql: &str,
        limits: Limits,
    ) -> Result<Rows, Refusal> {
        let answer = self.complete_database().and_then(|database| database.answer(ticket, sql, limits));
        answer.map_err(
            |refusal| {
                if self.may_look_inside() { with_the_way_to_hidden_tables(refusal) } else { refusal }
            },
        )
    }

    /// Runs a statement of the program, which is not recorded because the user did not enter it.
    ///
    /// # Errors
    /// The `sql_` codes.
    pub fn look_into_database(&mut self, sql: &str) -> Result<Rows, Refusal> {
        let limits = self.company().query_limits();
        let ticket = self.draw_ticket()?;
        self.complete_database()?.answer(ticket, sql, limits)
    }

    /// Returns the database, which may lack the newest rows.
    pub fn database(&self) -> &RunDatabase {
        &self.database
    }

    /// Waits until the database contains everything up to the last decision day and this week's calls.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn wait_for_database(&self) -> Result<(), Refusal> {
        let refused = |problem: String| Refusal::new("sql_error", problem);
        if self.log.sync_waiting_calls().map_err(|error| refused(error.to_string()))? {
            self.commit_projection();
        }
        self.database.wait().map_err(|error| refused(error.to_string()))
    }

    /// Records a query that was run elsewhere.
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

    /// Adds a statement to the query history, unless it came from a script.
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

    /// Returns the database with all rows. Repairs it if it could not be written before.
    ///
    /// # Errors
    /// The database cannot be written.
    pub fn complete_database(&mut self) -> Result<&mut RunDatabase, Refusal> {
        if let Err(problem) = self.wait_for_database() {
            // Disk space may be available again.
            self.mend_database().map_err(|_| problem)?;
        }
        Ok(&mut self.database)
    }
}
