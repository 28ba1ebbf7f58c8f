//! Creating a database: tables and the market observer.

use rusqlite::Connection;

use novamind_world::events::{Category, Source};

/// Layout version of the database. A file with another version is rebuilt. Increase it with every change of `schema.sql` or
/// of the written rows.
pub(crate) const LAYOUT_VERSION: u32 = 5;

/// Creates the tables and row 1 of `customers`: the market observer.
pub(crate) fn create_tables(connection: &mut Connection) -> rusqlite::Result<()> {
    let transaction = connection.transaction()?;
    transaction.execute_batch(include_str!("../schema.sql"))?;
    transaction.pragma_update(None, "user_version", LAYOUT_VERSION)?;
    transaction.execute(
        "INSERT INTO customer_rows (customer_id, group_id, created_day, email) \
         VALUES (1, 'S1', 0, 'market_observer@external')",
        [],
    )?;
    transaction.commit()
}

/// All sources fit the CASE of the view `customers`.
const _: () = assert!(Source::Organic as u8 == 6);
/// All categories fit the CASE of the view `ledger`.
const _: () = assert!(Category::ResearchProject as u8 == 11);
