//! `hidden.*`: what is hidden as tables, beside those of the company (docs/formats/hidden-tables.md).

use super::hidden_tables::{CUSTOMERS, HiddenTables, ShownCustomers, THREADS};
use crate::database::{Interrupt, Rows, Scope, Table, Ticket};
use crate::session::state::Session;
use crate::tools::Refusal;

impl Session {
    /// Answers a statement that may read the hidden tables. `hidden.customers` shows a day, the last one if none is named;
    /// all others have every day. The look is recorded.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`, the `sql_` codes.
    pub fn xray_query(&mut self, sql: &str, day: Option<u32>) -> Result<Rows, Refusal> {
        let ticket = self.xray_interrupt()?.ticket();
        self.xray_query_as(ticket, sql, day)
    }

    /// The same under a ticket of [`Session::xray_interrupt`] that was drawn when the statement was asked for.
    ///
    /// # Errors
    /// As [`Session::xray_query`].
    pub fn xray_query_as(&mut self, ticket: Ticket, sql: &str, day: Option<u32>) -> Result<Rows, Refusal> {
        self.refuse_to_look_inside()?;
        let day = self.day_to_show(day)?;
        self.record_look_inside("sql", sql, day)?;
        // Tables that went wrong are not kept: the next look begins anew.
        let mut tables = self.take_hidden_tables()?;
        for table in tables.connection().hidden_tables_in(sql) {
            match table.name.as_str() {
                CUSTOMERS => self.show_customers(&mut tables, ticket, table, day)?,
                _ => self.add_days(&mut tables, ticket, table)?,
            }
        }
        let limits = self.query_limits();
        let answer = tables.connection().ask_as(ticket, sql, limits);
        self.hidden_tables = Some(tables);
        Ok(answer?)
    }

    /// A handle that stops the running statement on hidden tables.
    ///
    /// # Errors
    /// `not_in_this_mode`; the run has no database.
    pub fn xray_interrupt(&mut self) -> Result<Interrupt, Refusal> {
        self.refuse_to_look_inside()?;
        let tables = self.take_hidden_tables()?;
        Ok(self.hidden_tables.insert(tables).connection().interrupt())
    }

    fn take_hidden_tables(&mut self) -> Result<HiddenTables, Refusal> {
        // The tables of the company are to hold everything up to now, as they do for any other statement.
        self.connection()?;
        match self.hidden_tables.take() {
            Some(tables) => Ok(tables),
            None => self.projection.open_connection(Scope::Hidden).map(HiddenTables::behind),
        }
    }

    fn show_customers(
        &self,
        tables: &mut HiddenTables,
        ticket: Ticket,
        table: &Table,
        day: u32,
    ) -> Result<(), Refusal> {
        let now = &self.simulation.world;
        let is_now = day == now.day;
        let wanted = if is_now { ShownCustomers::now(now) } else { ShownCustomers::Evening(day) };
        if tables.shows(wanted) {
            return Ok(());
        }
        match is_now {
            true => tables.show(ticket, table, wanted, now)?,
            false => tables.show(ticket, table, wanted, &self.world_on(day)?)?,
        }
        Ok(())
    }

    fn add_days(
        &mut self,
        tables: &mut HiddenTables,
        ticket: Ticket,
        table: &'static Table,
    ) -> Result<(), Refusal> {
        let days = tables.lacks_from(table)..=self.day();
        if days.is_empty() {
            return Ok(());
        }
        let seen = match table.name.as_str() {
            THREADS => self.hidden_days_with_threads(days)?,
            _ => self.hidden_days(days)?,
        };
        Ok(tables.append(ticket, table, &seen)?)
    }
}
