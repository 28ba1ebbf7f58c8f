//! Helpers for all crates, independent of the simulation: notation of numbers, statistics of small samples, and
//! search for similar names.

pub mod formatting;
mod similar_names;
pub mod statistics;

pub use similar_names::similar_names;
