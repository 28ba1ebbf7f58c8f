//! Queries on the hidden tables `hidden.*` and the visible tables (docs/formats/hidden-tables.md).

use super::hidden_tables::{CUSTOMERS_TABLE, CustomersSnapshot, HiddenTables, THREADS_TABLE};
use super::inspector::Inspector;
use novamind_database::{Interrupt, QueryResult, QueryTicket, Table};
use novamind_session::{InspectionPermit, query_rejection};
use novamind_tools::Rejection;

impl Inspector<'_> {
    /// Runs an SQL statement that may read hidden tables. `hidden.customers` contains one day, by default the last
    /// day. All other hidden tables contain every day. Records the inspection in the trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`, the `sql_` codes.
    pub fn query_hidden_tables(&mut self, sql: &str, day: Option<u32>) -> Result<QueryResult, Rejection> {
        let ticket = self.hidden_query_interrupt()?.issue_ticket();
        self.query_hidden_tables_with_ticket(ticket, sql, day)
    }

    /// Runs an SQL statement like [`Inspector::query_hidden_tables`]. `ticket` must be taken from
    /// [`Inspector::hidden_query_interrupt`] when the query is requested.
    ///
    /// # Errors
    /// Same errors as [`Inspector::query_hidden_tables`].
    pub fn query_hidden_tables_with_ticket(
        &mut self,
        ticket: QueryTicket,
        sql: &str,
        day: Option<u32>,
    ) -> Result<QueryResult, Rejection> {
        let permit = InspectionPermit::start(self.run, "sql", sql, day)?;
        // The tables are removed from the cache first, so that the next inspection rebuilds them after an error.
        let mut tables = self.take_hidden_tables()?;
        let named = tables.connection().hidden_tables_in(sql);
        // All tables are filled from one recorder, so the days are simulated only once.
        let keeps_threads =
            self.cache.hidden_days.records_threads() || named.iter().any(|table| table.name == THREADS_TABLE);
        for table in named {
            match table.name.as_str() {
                CUSTOMERS_TABLE => self.fill_customers(&permit, &mut tables, ticket, table)?,
                _ => self.fill_days(&permit, &mut tables, ticket, table, keeps_threads)?,
            }
        }
        let limits = self.run.company().query_limits();
        let answer = tables.connection().query_with_ticket(ticket, sql, limits);
        self.cache.hidden_tables = Some(tables);
        answer.map_err(query_rejection)
    }

    /// Returns a handle that can interrupt a running query on hidden tables.
    ///
    /// # Errors
    /// `not_in_this_mode`, or an error if the run has no database.
    pub fn hidden_query_interrupt(&mut self) -> Result<Interrupt, Rejection> {
        self.run.check_inspection()?;
        let tables = self.take_hidden_tables()?;
        Ok(self.cache.hidden_tables.insert(tables).connection().interrupt())
    }

    fn take_hidden_tables(&mut self) -> Result<HiddenTables, Rejection> {
        // The visible tables must be up to date before any statement runs.
        self.run.up_to_date_database()?;
        let database = self.run.database().replacement_count();
        match self.cache.hidden_tables.take().filter(|tables| tables.database_number() == database) {
            Some(tables) => Ok(tables),
            None => {
                let tables = HiddenTables::new(InspectionPermit::open_hidden_tables(self.run)?, database);
                if self.cache.hidden_days.records_threads() {
                    // The threads of the cached days were moved to tables that no longer exist.
                    self.cache.replay = None;
                }
                Ok(tables)
            }
        }
    }

    fn fill_customers(
        &self,
        permit: &InspectionPermit,
        tables: &mut HiddenTables,
        ticket: QueryTicket,
        table: &Table,
    ) -> Result<(), Rejection> {
        let (now, day) = (permit.hidden_state(self.run).world(), permit.day());
        let is_now = day == now.day;
        let wanted = if is_now { CustomersSnapshot::current(now) } else { CustomersSnapshot::DayEnd(day) };
        if tables.contains_customers(wanted) {
            return Ok(());
        }
        let shown = match is_now {
            true => tables.fill_customers(ticket, table, wanted, now),
            false => tables.fill_customers(ticket, table, wanted, &permit.world_at_day_end(self.run, day)?),
        };
        shown.map_err(query_rejection)
    }

    fn fill_days(
        &mut self,
        permit: &InspectionPermit,
        tables: &mut HiddenTables,
        ticket: QueryTicket,
        table: &'static Table,
        keeps_threads: bool,
    ) -> Result<(), Rejection> {
        let day = self.run.day();
        if !tables.is_missing_day(table, day) {
            return Ok(());
        }
        let day_recorder = self.all_hidden_days(permit, keeps_threads)?;
        tables.append_days(day, ticket, table, &day_recorder).map_err(query_rejection)
    }
}
