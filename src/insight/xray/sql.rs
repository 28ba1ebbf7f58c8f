//! The hidden tables `hidden.*`, together with the visible tables (docs/formats/hidden-tables.md).

use super::hidden_tables::{CUSTOMERS, HiddenTables, ShownCustomers, THREADS};
use super::inspector::Inspector;
use novamind_database::{Interrupt, Rows, Table, Ticket};
use novamind_session::{Look, query_refusal};
use novamind_tools::Refusal;

impl Inspector<'_> {
    /// Runs a statement that may read hidden tables. `hidden.customers` contains one day, by default the last one; all others
    /// contain every day. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`, the `sql_` codes.
    pub fn xray_query(&mut self, sql: &str, day: Option<u32>) -> Result<Rows, Refusal> {
        let ticket = self.xray_interrupt()?.ticket();
        self.xray_query_as(ticket, sql, day)
    }

    /// Runs a statement like [`Inspector::xray_query`] with a ticket of [`Inspector::xray_interrupt`] from the time of the request.
    ///
    /// # Errors
    /// As [`Inspector::xray_query`].
    pub fn xray_query_as(&mut self, ticket: Ticket, sql: &str, day: Option<u32>) -> Result<Rows, Refusal> {
        let look = Look::begin(self.run, "sql", sql, day)?;
        // After an error, the next inspection rebuilds the tables.
        let mut tables = self.take_hidden_tables()?;
        let named = tables.connection().hidden_tables_in(sql);
        // One recorder for all tables: the days are simulated only once.
        let keeps_threads = self.own.diary.keeps_threads() || named.iter().any(|table| table.name == THREADS);
        for table in named {
            match table.name.as_str() {
                CUSTOMERS => self.show_customers(&look, &mut tables, ticket, table)?,
                _ => self.add_days(&look, &mut tables, ticket, table, keeps_threads)?,
            }
        }
        let limits = self.run.company().query_limits();
        let answer = tables.connection().ask_as(ticket, sql, limits);
        self.own.hidden_tables = Some(tables);
        answer.map_err(query_refusal)
    }

    /// Returns a handle that stops the running statement on hidden tables.
    ///
    /// # Errors
    /// `not_in_this_mode`, or an error if the run has no database.
    pub fn xray_interrupt(&mut self) -> Result<Interrupt, Refusal> {
        self.run.refuse_to_look_inside()?;
        let tables = self.take_hidden_tables()?;
        Ok(self.own.hidden_tables.insert(tables).connection().interrupt())
    }

    fn take_hidden_tables(&mut self) -> Result<HiddenTables, Refusal> {
        // The visible tables must be complete, as for any other statement.
        self.run.complete_database()?;
        let database = self.run.database().replaced();
        match self.own.hidden_tables.take().filter(|tables| tables.database() == database) {
            Some(tables) => Ok(tables),
            None => {
                let tables = HiddenTables::behind(Look::hidden_tables(self.run)?, database);
                if self.own.diary.keeps_threads() {
                    // The threads of its days were moved to tables that no longer exist.
                    self.own.shadow = None;
                }
                Ok(tables)
            }
        }
    }

    fn show_customers(
        &self,
        look: &Look,
        tables: &mut HiddenTables,
        ticket: Ticket,
        table: &Table,
    ) -> Result<(), Refusal> {
        let (now, day) = (look.inside(self.run).world(), look.day());
        let is_now = day == now.day;
        let wanted = if is_now { ShownCustomers::now(now) } else { ShownCustomers::Evening(day) };
        if tables.shows(wanted) {
            return Ok(());
        }
        let shown = match is_now {
            true => tables.show(ticket, table, wanted, now),
            false => tables.show(ticket, table, wanted, &look.world_on(self.run, day)?),
        };
        shown.map_err(query_refusal)
    }

    fn add_days(
        &mut self,
        look: &Look,
        tables: &mut HiddenTables,
        ticket: Ticket,
        table: &'static Table,
        keeps_threads: bool,
    ) -> Result<(), Refusal> {
        let day = self.run.day();
        if !tables.lacks(table, day) {
            return Ok(());
        }
        let diary = self.diary_of_all_days(look, keeps_threads)?;
        tables.continue_to(day, ticket, table, &diary).map_err(query_refusal)
    }
}
