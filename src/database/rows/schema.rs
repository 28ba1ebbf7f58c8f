//! Creates the tables of a database.

use rusqlite::Connection;

use novamind_world::events::{Category, Source};

/// Layout version of the database. A file with another version is rebuilt. Increase the version with every change of
/// `schema.sql` or of the written rows.
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

/// The CASE expression of the view `customers` lists all lead sources.
const _: () = assert!(Source::Organic as u8 == 6);
/// The CASE expression of the view `ledger` lists all categories.
const _: () = assert!(Category::ResearchProject as u8 == 11);
