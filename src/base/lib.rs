//! Helpers for all crates, independent of the simulation: notation of numbers, statistics of small samples, and
//! search for similar names.

mod nearest;
pub mod notation;
pub mod statistics;

pub use nearest::nearest;
