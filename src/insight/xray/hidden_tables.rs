//! The hidden tables of an open run: the connection that has them, and how far they are filled.

use std::collections::BTreeMap;

use super::hidden_day::Diary;
use super::hidden_rows::{competitors, customers, drift, factors, groups, pmi, thread};
use novamind_database::{QueryConnection, QueryError, Table, Ticket};
use novamind_world::canonical::hash_of;
use novamind_world::state::World;

/// The connection of the x-ray. Nobody else has one that knows the hidden tables.
pub(crate) struct HiddenTables {
    connection: QueryConnection,
    /// The number of the database that it reads.
    database: u32,
    /// The last day in each table that has every day.
    days: BTreeMap<&'static str, u32>,
    /// What the table of customers shows; none before it was asked.
    shown: Option<ShownCustomers>,
}

/// What the table of customers shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ShownCustomers {
    /// They as they stand, calls since the last day included.
    Now {
        /// Hash of the columns of subscribers.
        customers: blake3::Hash,
        /// Hash of companies and threads.
        companies: blake3::Hash,
    },
    /// They on the evening of a day.
    Evening(u32),
}

impl ShownCustomers {
    /// They as they stand in a world.
    pub(crate) fn now(world: &World) -> ShownCustomers {
        ShownCustomers::Now { customers: world.customers.hash(), companies: hash_of(&world.enterprise) }
    }
}

/// The table that shows one day.
pub(crate) const CUSTOMERS: &str = "hidden.customers";
/// The table whose rows are kept only once it was asked.
pub(crate) const THREADS: &str = "hidden.threads";

impl HiddenTables {
    /// Empty tables behind a connection to a database of the run.
    pub(crate) fn behind(connection: QueryConnection, database: u32) -> HiddenTables {
        HiddenTables { connection, database, days: BTreeMap::new(), shown: None }
    }

    /// The number of the database that it reads.
    pub(crate) fn database(&self) -> u32 {
        self.database
    }

    /// The connection.
    pub(crate) fn connection(&self) -> &QueryConnection {
        &self.connection
    }

    /// Whether a table that has every day lacks one.
    pub(crate) fn lacks(&self, table: &Table, day: u32) -> bool {
        self.filled_to(table) < day
    }

    fn filled_to(&self, table: &Table) -> u32 {
        self.days.get(table.name.as_str()).copied().unwrap_or(0)
    }

    /// Whether the table of customers shows this already.
    pub(crate) fn shows(&self, wanted: ShownCustomers) -> bool {
        self.shown == Some(wanted)
    }

    /// Continues a table that has every day up to one of them, from a diary. The diary hands its threads over.
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

    /// Lets the table of customers show those of a world.
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
