//! A copy of the database for other programs: every visible table is an ordinary table or view in it, so any SQLite
//! tool can read it without this program.

use std::path::Path;
use std::time::Duration;

use rusqlite::backup::Backup;
use rusqlite::{Connection, Transaction, params};

use super::blocks::{AdsRun, BlockStore};
use super::projector::{ProjectionError, Projector};
use crate::world::events::UsageRows;

/// The two tables that the program serves itself, as ordinary ones. A row per day and customer.
const TABLES: &str = "CREATE TABLE daily_usage (day INTEGER NOT NULL, customer_id INTEGER NOT NULL, usage_units INTEGER NOT NULL);
CREATE TABLE ads_revenue (day INTEGER NOT NULL, customer_id INTEGER NOT NULL, group_id TEXT NOT NULL,
    ads_strength REAL NOT NULL, revenue REAL NOT NULL);";

/// What questions about one customer need.
const INDEXES: &str = "CREATE INDEX daily_usage_by_customer ON daily_usage (customer_id, day);
CREATE INDEX ads_revenue_by_customer ON ads_revenue (customer_id, day);
DROP TABLE usage_blocks;
DROP TABLE ads_blocks;";

/// Pages that are copied at a time.
const PAGES: i32 = 4096;

impl Projector {
    /// Writes everything handed over so far into a new file that any SQLite tool can open.
    ///
    /// # Errors
    /// The database could not be written, or the file cannot be made.
    pub fn copy_for_other_programs(&self, file: &Path) -> Result<(), ProjectionError> {
        self.wait()?;
        let store = self.store.read().unwrap_or_else(|poisoned| poisoned.into_inner()).clone();
        let copied = self.location.open_reader().and_then(|source| copy(&source, &store, file));
        copied.map_err(|error| ProjectionError(format!("{}: {error}", file.display())))
    }
}

fn copy(source: &Connection, store: &BlockStore, file: &Path) -> rusqlite::Result<()> {
    let mut copy = Connection::open(file)?;
    Backup::new(source, &mut copy)?.run_to_completion(PAGES, Duration::ZERO, None)?;
    // One file without companions, and nothing to save it from: what is half written is thrown away.
    copy.pragma_update(None, "journal_mode", "OFF")?;
    copy.pragma_update(None, "synchronous", "OFF")?;
    let transaction = copy.transaction()?;
    transaction.execute_batch(TABLES)?;
    copy_usage(&transaction, store)?;
    copy_ads(&transaction, store)?;
    transaction.execute_batch(INDEXES)?;
    transaction.commit()?;
    copy.execute_batch("VACUUM")?;
    copy.pragma_update(None, "journal_mode", "DELETE")
}

fn copy_usage(transaction: &Transaction<'_>, store: &BlockStore) -> rusqlite::Result<()> {
    let mut insert = transaction.prepare("INSERT INTO daily_usage VALUES (?1, ?2, ?3)")?;
    for day in store.usage.iter() {
        for run in (0..day.len()).filter_map(|run| day.open::<UsageRows>(run)) {
            for (customer, units) in run.customers.iter().zip(&run.units) {
                insert.execute(params![day.day, customer, units])?;
            }
        }
    }
    Ok(())
}

fn copy_ads(transaction: &Transaction<'_>, store: &BlockStore) -> rusqlite::Result<()> {
    let mut insert = transaction.prepare("INSERT INTO ads_revenue VALUES (?1, ?2, ?3, ?4, ?5)")?;
    for day in store.ads.iter() {
        for run in (0..day.len()).filter_map(|run| day.open::<AdsRun>(run)) {
            for (at, customer) in run.customers.iter().enumerate() {
                insert.execute(params![
                    day.day,
                    customer,
                    run.group.id(),
                    run.strengths[at],
                    run.revenues[at]
                ])?;
            }
        }
    }
    Ok(())
}
