//! Loads packed days from the database file. The writer loads all tables. Queries on a file that has no writer in this
//! process load only the tables that their statements name.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::sync::{Arc, RwLock};

use rusqlite::Connection;

use super::blocks::{AdsRun, BlockStore, SharedStore};
use super::issues::IssueRun;
use super::ledger::LedgerDay;
use super::notices::{Inbox, NoticeDay, RepeatedLoss};
use super::packing::{PackedDay, RowRun};
use novamind_world::events::{LossCause, UsageRows};

/// Loads the packed days of one table. Returns `None` if a day is damaged.
type Loader = fn(&Connection, &mut BlockStore) -> Option<()>;

const LOADERS: [(&str, Loader); 5] = [
    ("daily_usage", load_usage),
    ("ads_revenue", load_ads),
    ("notifications", load_notices),
    ("issues", load_issues),
    ("ledger", load_ledger),
];

/// Loads the packed days of all tables. Returns `None` if a day is damaged.
pub(super) fn load_store(connection: &Connection) -> Option<BlockStore> {
    let mut store = BlockStore::default();
    LOADERS.iter().try_for_each(|(_, load)| load(connection, &mut store))?;
    Some(store)
}

/// Source of the packed days that a query reads.
pub(super) enum BlockSource {
    /// The writer's store, and a lock that excludes readers while a transaction commits, so that its rows and blocks
    /// become visible together.
    Writer(SharedStore, Arc<RwLock<()>>),
    /// A file without a writer in this process. The packed days of a table are loaded when a statement first names the
    /// table.
    File(RefCell<FileBlocks>),
}

/// The packed days of the tables that previous statements named.
#[derive(Default)]
pub(super) struct FileBlocks {
    store: BlockStore,
    loaded: BTreeSet<&'static str>,
    /// Value of SQLite's `data_version` when the packed days were loaded.
    version: Option<i64>,
    damaged: bool,
}

impl FileBlocks {
    /// Returns the loaded packed days.
    pub fn store(&self) -> &BlockStore {
        &self.store
    }

    /// Returns whether a query found damaged packed days.
    pub fn is_damaged(&self) -> bool {
        self.damaged
    }

    /// Unloads all packed days if the file has changed.
    pub fn refresh(&mut self, connection: &Connection) {
        let version = connection.query_row("PRAGMA data_version", [], |row| row.get::<_, i64>(0)).ok();
        if version.is_none() || version != self.version {
            *self = FileBlocks { version, damaged: self.damaged, ..FileBlocks::default() };
        }
    }

    /// Loads the tables in `tables` that are not loaded yet. Returns `false` if a day is damaged or loading was
    /// stopped.
    pub fn load(&mut self, connection: &Connection, tables: &[String]) -> bool {
        for (table, load) in LOADERS {
            if !tables.iter().any(|text| text == table) || self.loaded.contains(table) {
                continue;
            }
            if load(connection, &mut self.store).is_none() {
                return false;
            }
            self.loaded.insert(table);
        }
        true
    }

    /// Records that a query found damaged packed days.
    pub fn mark_damaged(&mut self) {
        self.damaged = true;
    }
}

fn load_usage(connection: &Connection, store: &mut BlockStore) -> Option<()> {
    store.usage = Arc::new(load_runs::<UsageRows>(connection, "usage_blocks")?);
    Some(())
}

fn load_ads(connection: &Connection, store: &mut BlockStore) -> Option<()> {
    store.ads = Arc::new(load_runs::<AdsRun>(connection, "ads_blocks")?);
    Some(())
}

fn load_notices(connection: &Connection, store: &mut BlockStore) -> Option<()> {
    store.inbox = load_inbox(connection)?;
    Some(())
}

fn load_issues(connection: &Connection, store: &mut BlockStore) -> Option<()> {
    store.issues = Arc::new(load_runs::<IssueRun>(connection, "issue_blocks")?);
    store.issue_clock = Arc::new(load_clock(connection)?);
    Some(())
}

fn load_ledger(connection: &Connection, store: &mut BlockStore) -> Option<()> {
    store.ledger = Arc::new(load_days(connection, "ledger_blocks", LedgerDay::from_bytes)?);
    Some(())
}

fn load_runs<R: RowRun>(connection: &Connection, table: &str) -> Option<Vec<Arc<PackedDay>>> {
    let mut statement = connection.prepare(&format!("SELECT day, packed FROM {table} ORDER BY day")).ok()?;
    let rows = statement.query_map([], |row| Ok((row.get::<_, u32>(0)?, row.get::<_, Vec<u8>>(1)?))).ok()?;
    rows.map(|row| row.ok().and_then(|(day, packed)| PackedDay::from_bytes::<R>(day, packed)).map(Arc::new))
        .collect()
}

/// Loads the packed days of a table. Returns `None` if a day is damaged.
fn load_days<D>(
    connection: &Connection,
    table: &str,
    read: impl Fn(u32, &[u8]) -> Option<D>,
) -> Option<Vec<Arc<D>>> {
    let mut statement = connection.prepare(&format!("SELECT day, packed FROM {table} ORDER BY day")).ok()?;
    let rows = statement.query_map([], |row| Ok((row.get::<_, u32>(0)?, row.get::<_, Vec<u8>>(1)?))).ok()?;
    rows.map(|row| row.ok().and_then(|(day, packed)| read(day, &packed)).map(Arc::new)).collect()
}

/// Loads the values of the issue clock after each day, starting with day 0.
fn load_clock(connection: &Connection) -> Option<Vec<u32>> {
    let mut statement = connection.prepare("SELECT aged FROM issue_clock ORDER BY day").ok()?;
    let rows = statement.query_map([], |row| row.get(0)).ok()?;
    rows.collect::<Result<_, _>>().ok()
}

fn load_inbox(connection: &Connection) -> Option<Inbox> {
    let days = load_days(connection, "notice_blocks", NoticeDay::from_bytes)?;
    let sql = "SELECT customer_id, message_day, cause FROM repeated_losses ORDER BY number";
    let mut statement = connection.prepare(sql).ok()?;
    let loss = |row: &rusqlite::Row<'_>| {
        let cause = if row.get(2)? { LossCause::Unanswered } else { LossCause::Silence };
        Ok(RepeatedLoss { customer: row.get(0)?, message_day: row.get(1)?, cause })
    };
    let losses: Vec<_> = statement.query_map([], loss).ok()?.collect::<Result<_, _>>().ok()?;
    let sound = days.iter().all(|day| day.repeats as usize <= losses.len());
    sound.then(|| Inbox { days: Arc::new(days), losses: Arc::new(losses) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::params::Interface;

    #[test]
    fn every_loader_has_a_catalogue_table() {
        for (table, _) in LOADERS {
            assert!(super::super::catalogue::table(Interface::Release1, table).is_some(), "{table}");
        }
    }
}
