//! The observable company as a database for SQL queries of the player.
//!
//! `world.db` is a projection of the facts of each day. A writer thread ([`Projector`]) converts facts to rows while the player
//! reads and decides, and the file can be rebuilt from the trajectory at any time. Queries use a guarded read-only connection
//! ([`QueryConnection`]). Hidden state is never written here, so no query, tool or editor can find it
//! (docs/formats/database.md). The connection of the x-ray has hidden tables in separate memory (docs/formats/hidden-tables.md).

pub mod catalogue;
pub mod query;
pub mod text;

mod answer;
mod block_table;
mod blocks;
mod by_customer;
mod by_text;
mod day_table;
mod filling;
mod guard;
mod help;
mod hidden;
mod interrupt;
mod issues;
mod ledger;
mod loading;
mod location;
mod mathematics;
mod memory;
mod notices;
mod packed_tables;
mod packing;
mod plain_copy;
mod plan;
mod projector;
mod released;
mod rows;
mod tokens;

#[cfg(test)]
mod tests;

pub use answer::{Cell, Rows, number_at, text_at};
pub use catalogue::{Column, Scope, Table, hidden_tables, table, tables};
pub use hidden::HiddenValue;
pub use interrupt::{Interrupt, Ticket};
pub use location::Location;
pub use mathematics::register_mathematics;
pub use plain_copy::copy_for_other_programs;
pub use projector::{
    Position, ProjectionError, Projector, file_digest, has_layout_of_now, is_consistent, owner_of,
    position_of, query_connection,
};
pub use query::{QueryConnection, QueryError, ScriptError};
pub use rows::{Entry, ForecastRow};
