//! A database of the observable company, for the player's SQL queries.
//!
//! `world.db` is a projection of the facts of each day. A writer thread ([`Projector`]) converts facts to rows while
//! the player reads and decides, and the file can be rebuilt from the trajectory at any time. Queries use a guarded
//! read-only connection ([`QueryConnection`]). Hidden state is never written to this database, so no query, tool or
//! editor can find it (docs/formats/database.md). The connection of the x-ray has hidden tables in separate memory
//! (docs/formats/hidden-tables.md).

pub mod catalogue;
pub mod query;
pub mod text;

mod block_loading;
mod block_table;
mod blocks;
mod customer_index;
mod day_table;
mod error_help;
mod guard;
mod hidden_schema;
mod hidden_table_rows;
mod issues;
mod ledger;
mod location;
mod math_functions;
mod memory;
mod notices;
mod packed_tables;
mod packing;
mod projector;
mod query_interrupt;
mod query_plan;
mod query_result;
mod released_schema;
mod rows;
mod sqlite_export;
mod text_index;
mod tokens;

#[cfg(test)]
mod release_2_tests;
#[cfg(test)]
mod tests;

pub use catalogue::{Column, Scope, Table, hidden_tables, table, tables};
pub use hidden_schema::HiddenValue;
pub use location::DatabaseLocation;
pub use math_functions::register_math_functions;
pub use novamind_world::params::Interface;
pub use projector::{
    ProjectionError, ProjectionPosition, Projector, file_digest, has_current_layout, is_consistent,
    query_connection, read_owner, read_position,
};
pub use query::{QueryConnection, QueryError, ScriptError};
pub use query_interrupt::{Interrupt, QueryTicket};
pub use query_result::{Cell, QueryResult, number_at, text_at};
pub use rows::{ForecastRow, ProjectionEntry};
pub use rusqlite::version as sqlite_version;
pub use sqlite_export::export_sqlite;
