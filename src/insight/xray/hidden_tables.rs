//! The hidden tables of an open run: their connection, and the days that they contain.

use std::collections::BTreeMap;

use super::hidden_day::Diary;
use super::hidden_rows::{competitors, customers, drift, factors, groups, pmi, thread};
use novamind_database::{QueryConnection, QueryError, Table, Ticket};
use novamind_world::canonical::hash_of;
use novamind_world::state::World;

/// The connection of the x-ray, the only one with hidden tables.
pub(crate) struct HiddenTables {
    connection: QueryConnection,
    database: u32,
    /// Last day in each table that contains every day.
    days: BTreeMap<&'static str, u32>,
    /// Content of the customer table; `None` before its first use.
    shown: Option<ShownCustomers>,
}

/// The content of the customer table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ShownCustomers {
    /// The current state, including calls since the last day.
    Now {
        /// Hash of the subscriber columns.
        customers: blake3::Hash,
        /// Hash of enterprises and threads.
        companies: blake3::Hash,
    },
    /// The state at the end of a day.
    Evening(u32),
}

impl ShownCustomers {
    pub(crate) fn now(world: &World) -> ShownCustomers {
        ShownCustomers::Now { customers: world.customers.hash(), companies: hash_of(&world.enterprise) }
    }
}

/// The table that contains one day.
pub(crate) const CUSTOMERS: &str = "hidden.customers";
/// The table whose rows are recorded only after its first use.
pub(crate) const THREADS: &str = "hidden.threads";

impl HiddenTables {
    /// Creates empty tables on a connection to a database of the run.
    pub(crate) fn behind(connection: QueryConnection, database: u32) -> HiddenTables {
        HiddenTables { connection, database, days: BTreeMap::new(), shown: None }
    }

    pub(crate) fn database(&self) -> u32 {
        self.database
    }

    pub(crate) fn connection(&self) -> &QueryConnection {
        &self.connection
    }

    /// Whether a table that contains every day lacks one.
    pub(crate) fn lacks(&self, table: &Table, day: u32) -> bool {
        self.filled_to(table) < day
    }

    fn filled_to(&self, table: &Table) -> u32 {
        self.days.get(table.name.as_str()).copied().unwrap_or(0)
    }

    /// Whether the customer table already has this content.
    pub(crate) fn shows(&self, wanted: ShownCustomers) -> bool {
        self.shown == Some(wanted)
    }

    /// Extends a table up to a day with recorded days. Takes the threads of these days.
    pub(crate) fn continue_to(
        &mut self,
        day: u32,
        ticket: Ticket,
        table: &'static Table,
        diary: &Diary,
    ) -> Result<(), QueryError> {
        let lacking = self.filled_to(table) + 1..=day;
        let own = &self.connection;
        match table.name.as_str() {
            "hidden.groups" => {
                let rows = lacking.filter_map(|day| diary.read(day, |seen| groups(day, seen)));
                own.fill_hidden(ticket, table, false, rows.flatten())
            }
            "hidden.drift" => {
                let rows = lacking.filter_map(|day| diary.read(day, |seen| drift(day, seen)));
                own.fill_hidden(ticket, table, false, rows.flatten())
            }
            "hidden.factors" => {
                let rows = lacking.filter_map(|day| diary.read(day, |seen| factors(day, seen)));
                own.fill_hidden(ticket, table, false, rows.flatten())
            }
            "hidden.competitors" => {
                let rows = lacking.filter_map(|day| diary.read(day, |seen| competitors(day, seen)));
                own.fill_hidden(ticket, table, false, rows)
            }
            "hidden.pmi" => {
                let rows = lacking.filter_map(|day| diary.read(day, |seen| pmi(day, seen)));
                own.fill_hidden(ticket, table, false, rows)
            }
            _ => {
                let threads = lacking.flat_map(|day| diary.take_threads(day));
                own.fill_hidden(ticket, table, false, threads.map(|own| thread(&own)))
            }
        }?;
        self.days.insert(&table.name, day);
        Ok(())
    }

    /// Fills the customer table from a world.
    pub(crate) fn show(
        &mut self,
        ticket: Ticket,
        table: &Table,
        wanted: ShownCustomers,
        world: &World,
    ) -> Result<(), QueryError> {
        self.connection.fill_hidden(ticket, table, true, customers(world))?;
        self.shown = Some(wanted);
        Ok(())
    }
}
