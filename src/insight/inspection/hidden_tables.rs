//! The hidden tables of an open run, with their database connection and the days that they contain.

use std::collections::BTreeMap;

use super::hidden_day::HiddenDayRecorder;
use super::hidden_rows::{
    competitor_row, customer_rows, drift_rows, factor_rows, group_rows, pmi_row, thread_row,
};
use novamind_database::{QueryConnection, QueryError, QueryTicket, Table};
use novamind_world::canonical::canonical_hash;
use novamind_world::state::World;

/// The hidden tables with their database connection. No other connection has hidden tables.
pub(crate) struct HiddenTables {
    connection: QueryConnection,
    database_number: u32,
    /// Last filled day of each table that contains every day, by table name.
    filled_days: BTreeMap<&'static str, u32>,
    /// Content of `hidden.customers`; `None` before its first use.
    shown: Option<CustomersSnapshot>,
}

/// The state that the table `hidden.customers` currently shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CustomersSnapshot {
    /// The current state, including calls since the last simulated day.
    Current {
        /// Hash of the subscriber columns.
        customers: blake3::Hash,
        /// Hash of the columns of enterprises and threads.
        companies: blake3::Hash,
    },
    /// The state at the end of the given day.
    DayEnd(u32),
}

impl CustomersSnapshot {
    pub(crate) fn current(world: &World) -> CustomersSnapshot {
        CustomersSnapshot::Current {
            customers: world.customers.hash(),
            companies: canonical_hash(&world.enterprise),
        }
    }
}

/// Name of the table that contains only one day.
pub(crate) const CUSTOMERS_TABLE: &str = "hidden.customers";
/// Name of the table whose rows are recorded only after its first use.
pub(crate) const THREADS_TABLE: &str = "hidden.threads";

impl HiddenTables {
    /// Creates empty hidden tables on a connection to the run's database.
    pub(crate) fn new(connection: QueryConnection, database: u32) -> HiddenTables {
        HiddenTables { connection, database_number: database, filled_days: BTreeMap::new(), shown: None }
    }

    pub(crate) fn database_number(&self) -> u32 {
        self.database_number
    }

    pub(crate) fn connection(&self) -> &QueryConnection {
        &self.connection
    }

    /// Returns whether a table that contains every day still lacks `day`.
    pub(crate) fn is_missing_day(&self, table: &Table, day: u32) -> bool {
        self.last_filled_day(table) < day
    }

    fn last_filled_day(&self, table: &Table) -> u32 {
        self.filled_days.get(table.name.as_str()).copied().unwrap_or(0)
    }

    /// Returns whether `hidden.customers` already has the wanted content.
    pub(crate) fn contains_customers(&self, wanted: CustomersSnapshot) -> bool {
        self.shown == Some(wanted)
    }

    /// Appends recorded days to a table, up to a given day. Moves the threads of these days to the table.
    pub(crate) fn append_days(
        &mut self,
        day: u32,
        ticket: QueryTicket,
        table: &'static Table,
        recorder: &HiddenDayRecorder,
    ) -> Result<(), QueryError> {
        let lacking = self.last_filled_day(table) + 1..=day;
        let query_connection = &self.connection;
        match table.name.as_str() {
            "hidden.groups" => {
                let rows = lacking.filter_map(|day| recorder.with_day(day, |seen| group_rows(day, seen)));
                query_connection.fill_hidden_table(ticket, table, false, rows.flatten())
            }
            "hidden.drift" => {
                let rows = lacking.filter_map(|day| recorder.with_day(day, |seen| drift_rows(day, seen)));
                query_connection.fill_hidden_table(ticket, table, false, rows.flatten())
            }
            "hidden.factors" => {
                let rows = lacking.filter_map(|day| recorder.with_day(day, |seen| factor_rows(day, seen)));
                query_connection.fill_hidden_table(ticket, table, false, rows.flatten())
            }
            "hidden.competitors" => {
                let rows = lacking.filter_map(|day| recorder.with_day(day, |seen| competitor_row(day, seen)));
                query_connection.fill_hidden_table(ticket, table, false, rows)
            }
            "hidden.pmi" => {
                let rows = lacking.filter_map(|day| recorder.with_day(day, |seen| pmi_row(day, seen)));
                query_connection.fill_hidden_table(ticket, table, false, rows)
            }
            _ => {
                let threads = lacking.flat_map(|day| recorder.take_threads(day));
                query_connection.fill_hidden_table(
                    ticket,
                    table,
                    false,
                    threads.map(|thread_day| thread_row(&thread_day)),
                )
            }
        }?;
        self.filled_days.insert(&table.name, day);
        Ok(())
    }

    /// Fills `hidden.customers` from a state of the world.
    pub(crate) fn fill_customers(
        &mut self,
        ticket: QueryTicket,
        table: &Table,
        wanted: CustomersSnapshot,
        world: &World,
    ) -> Result<(), QueryError> {
        self.connection.fill_hidden_table(ticket, table, true, customer_rows(world))?;
        self.shown = Some(wanted);
        Ok(())
    }
}
