//! A copy of the database for other programs: every visible table is an ordinary table or view, readable by any SQLite
//! tool.

use std::path::Path;
use std::time::Duration;

use rusqlite::backup::Backup;
use rusqlite::{Connection, Transaction, params};

use super::block_loading::load_store;
use super::blocks::{AdsRun, BlockStore};
use super::catalogue::{Table, table, tables};
use super::issues::{IssueRun, days_open};
use super::location::DatabaseLocation;
use super::notices::{Inbox, NOTICE_TYPES, NoticeSlot};
use super::packing::PackedRows;
use super::projector::{ProjectionError, Projector};
use novamind_world::events::UsageRows;
use novamind_world::params::Interface;

/// Statements that create ordinary tables to replace the virtual tables. Repeated losses become a view over days and
/// losses.
const TABLE_STATEMENTS: &str = "CREATE TABLE daily_usage (day INTEGER NOT NULL, customer_id INTEGER NOT NULL, usage_units INTEGER NOT NULL);
CREATE TABLE ads_revenue (day INTEGER NOT NULL, customer_id INTEGER NOT NULL, group_id TEXT NOT NULL,
    ads_strength REAL NOT NULL, revenue REAL NOT NULL);
CREATE TABLE ledger (id INTEGER PRIMARY KEY, day INTEGER NOT NULL, category TEXT NOT NULL, amount REAL NOT NULL, note TEXT);
CREATE TABLE issues (issue_id INTEGER PRIMARY KEY, customer_id INTEGER NOT NULL, group_id TEXT NOT NULL,
    open_day INTEGER NOT NULL, days_open INTEGER NOT NULL, status TEXT NOT NULL, resolved_day INTEGER,
    resolution_type TEXT);
CREATE TABLE notice_rows (notification_id INTEGER PRIMARY KEY, day INTEGER NOT NULL, type TEXT NOT NULL, message TEXT NOT NULL);
CREATE TABLE repeating_days (day INTEGER PRIMARY KEY, first_number INTEGER NOT NULL, losses INTEGER NOT NULL);
CREATE TABLE repeating_losses (number INTEGER PRIMARY KEY, message TEXT NOT NULL);
CREATE VIEW notifications AS
SELECT notification_id, day, type, message FROM notice_rows
UNION ALL
SELECT first_number + number, day, 'lead_lost', message FROM repeating_days JOIN repeating_losses ON number < losses;";

/// Statements that create indexes by customer, and by day for the ledger, and drop the internal tables.
const INDEX_STATEMENTS: &str = "CREATE INDEX daily_usage_by_customer ON daily_usage (customer_id, day);
CREATE INDEX ads_revenue_by_customer ON ads_revenue (customer_id, day);
CREATE INDEX issues_by_customer ON issues (customer_id);
CREATE INDEX ledger_by_day ON ledger (day);
DROP TABLE ledger_blocks;
DROP TABLE issue_blocks;
DROP TABLE issue_clock;
DROP TABLE usage_blocks;
DROP TABLE ads_blocks;
DROP TABLE notice_blocks;
DROP TABLE repeated_losses;";

const PAGES_PER_STEP: i32 = 4096;

impl Projector {
    /// Writes all entries that the projector has received to a new file that any SQLite tool can open.
    ///
    /// # Errors
    /// The database could not be written, or the file cannot be created.
    pub fn export_sqlite(&self, file: &Path) -> Result<(), ProjectionError> {
        self.flush()?;
        let store = self.store.read().unwrap_or_else(|poisoned| poisoned.into_inner()).clone();
        let copied = self
            .location
            .open_reader()
            .and_then(|source| write_sqlite_file(&source, &store, self.interface, file));
        copied.map_err(|error| ProjectionError(format!("{}: {error}", file.display())))
    }
}

/// Writes a copy of the database at a location to a new file that any SQLite tool can open. `interface` is the release
/// that its run follows.
///
/// # Errors
/// The database cannot be read, or the file cannot be created.
pub fn export_sqlite(
    location: &DatabaseLocation,
    interface: Interface,
    file: &Path,
) -> Result<(), ProjectionError> {
    let file_error = |problem: String| ProjectionError(format!("{}: {problem}", file.display()));
    let source = location.open_reader().map_err(|error| file_error(error.to_string()))?;
    let store = load_store(&source).ok_or_else(|| file_error("the database cannot be read".to_owned()))?;
    write_sqlite_file(&source, &store, interface, file).map_err(|error| file_error(error.to_string()))
}

fn write_sqlite_file(
    source: &Connection,
    store: &BlockStore,
    interface: Interface,
    file: &Path,
) -> rusqlite::Result<()> {
    let mut copy = Connection::open(file)?;
    Backup::new(source, &mut copy)?.run_to_completion(PAGES_PER_STEP, Duration::ZERO, None)?;
    // The copy needs no journal, because an incomplete copy is deleted.
    copy.pragma_update(None, "journal_mode", "OFF")?;
    copy.pragma_update(None, "synchronous", "OFF")?;
    let transaction = copy.transaction()?;
    transaction.execute_batch(TABLE_STATEMENTS)?;
    copy_usage(&transaction, store)?;
    copy_ads(&transaction, store)?;
    copy_inbox(&transaction, &store.inbox)?;
    copy_ledger(&transaction, store)?;
    copy_issues(&transaction, store)?;
    declare_price_type(&transaction)?;
    for changed in tables(interface) {
        if table(Interface::Release1, &changed.name) != Some(changed) {
            replace_columns(&transaction, changed)?;
        }
    }
    transaction.execute_batch(INDEX_STATEMENTS)?;
    transaction.commit()?;
    copy.execute_batch("VACUUM")?;
    copy.pragma_update(None, "journal_mode", "DELETE")
}

/// Casts `subscriptions.effective_price` in the view. When SQLite before 3.52 sorts complete rows, it returns whole
/// numbers of a generated column as integers.
fn declare_price_type(transaction: &Transaction<'_>) -> rusqlite::Result<()> {
    let view_query = "SELECT sql FROM sqlite_schema WHERE type = 'view' AND name = 'subscriptions'";
    let view: String = transaction.query_row(view_query, [], |row| row.get(0))?;
    let typed = view.replace("    effective_price,", "    CAST(effective_price AS REAL) AS effective_price,");
    transaction.execute_batch(&format!("DROP VIEW subscriptions;\n{typed}"))
}

/// Replaces a table or view with a view that has the columns of another release.
fn replace_columns(transaction: &Transaction<'_>, table: &Table) -> rusqlite::Result<()> {
    let (name, columns) = (&table.name, table.column_names().join(", "));
    let of_table = "SELECT type, sql FROM sqlite_schema WHERE name = ?1";
    let (kind, sql): (String, String) =
        transaction.query_row(of_table, [name], |row| Ok((row.get(0)?, row.get(1)?)))?;
    let (renamed, rows) = match kind.as_str() {
        "view" => (format!("DROP VIEW {name}"), sql.split_once(" AS").map_or("", |(_, rows)| rows)),
        _ => (format!("ALTER TABLE {name} RENAME TO {name}_rows"), &*format!("SELECT * FROM {name}_rows")),
    };
    transaction.execute_batch(&format!("{renamed};\nCREATE VIEW {name} AS SELECT {columns} FROM ({rows}\n)"))
}

fn copy_usage(transaction: &Transaction<'_>, store: &BlockStore) -> rusqlite::Result<()> {
    let mut insert = transaction.prepare("INSERT INTO daily_usage VALUES (?1, ?2, ?3)")?;
    for day in store.usage.iter() {
        for run in (0..day.run_count()).filter_map(|run| day.unpack_run::<UsageRows>(run)) {
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
        for run in (0..day.run_count()).filter_map(|run| day.unpack_run::<AdsRun>(run)) {
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

fn copy_inbox(transaction: &Transaction<'_>, inbox: &Inbox) -> rusqlite::Result<()> {
    let mut statement = transaction.prepare("INSERT INTO notice_rows VALUES (?1, ?2, ?3, ?4)")?;
    let mut repeating = transaction.prepare("INSERT INTO repeating_days VALUES (?1, ?2, ?3)")?;
    for day in inbox.days.iter() {
        let number = |place: u64| (day.first + place) as i64;
        for place in 0..day.len() {
            if let NoticeSlot::Stored(at) = day.notice_at(place) {
                let notice_type = NOTICE_TYPES[usize::from(day.type_at(at))];
                statement.execute(params![number(place), day.day, notice_type, day.text_at(at)])?;
            }
        }
        repeating.execute(params![day.day, number(u64::from(day.before_repeats)), day.repeats])?;
    }
    let mut losses = transaction.prepare("INSERT INTO repeating_losses VALUES (?1, ?2)")?;
    for (number, loss) in (0u32..).zip(inbox.losses.iter()) {
        losses.execute(params![number, loss.text()])?;
    }
    Ok(())
}

fn copy_ledger(transaction: &Transaction<'_>, store: &BlockStore) -> rusqlite::Result<()> {
    let mut insert = transaction.prepare("INSERT INTO ledger VALUES (?1, ?2, ?3, ?4, ?5)")?;
    for day in store.ledger.iter() {
        for (number, category, amount, note) in day.rows() {
            insert.execute(params![number as i64, day.day(), category, amount, note])?;
        }
    }
    Ok(())
}

fn copy_issues(transaction: &Transaction<'_>, store: &BlockStore) -> rusqlite::Result<()> {
    let mut insert = transaction.prepare("INSERT INTO issues VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)")?;
    for day in store.issues.iter() {
        for run in (0..day.run_count()).filter_map(|run| day.unpack_run::<IssueRun>(run)) {
            for (at, customer) in run.customers.iter().enumerate() {
                let solved = Some(run.solved[at]).filter(|day| *day > 0);
                let (status, how) = match solved {
                    Some(_) => ("resolved", Some("ops_resolved")),
                    None => ("open", None),
                };
                let aged = days_open(&store.issue_clock, day.day, solved);
                let issue = run.first + at as u32;
                insert.execute(params![
                    issue,
                    customer,
                    run.group.id(),
                    day.day,
                    aged,
                    status,
                    solved,
                    how
                ])?;
            }
        }
    }
    Ok(())
}
