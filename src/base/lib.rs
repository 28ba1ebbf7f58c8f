//! Helpers for all crates, independent of the simulation: number formatting, statistics of small samples, and
//! suggestions of similar names.

pub mod formatting;
mod similar_names;
pub mod statistics;

pub use similar_names::similar_names;
