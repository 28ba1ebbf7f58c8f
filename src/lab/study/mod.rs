//! Studies of policies by scenarios, parameters and seeds, optionally split into shards (docs/laboratory/study.md).
//!
//! A study file defines numbered runs. Shard i of n plays the runs i, i + n, i + 2n, …, and
//! `lab merge` writes the rows of all shards in the order of their runs. The result equals that of the unsplit study.

mod definition;
mod grid;
mod merge;
mod shard;
mod summary;
mod table;
#[cfg(test)]
mod tests;

pub use definition::StudyPlan;
pub use merge::{MergeError, Shards};
pub use shard::{Shard, ShardHead, parse_shard};
pub use summary::{equal_arms, played_alike, size, summary};
pub use table::{head, rows};
