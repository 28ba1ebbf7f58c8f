//! Large studies: policies by scenarios by parameters by seeds, in shards if they are to be split (docs/laboratory/study.md).
//!
//! A study file names what is played; every run has a number. Shard i of n plays the runs i, i + n, i + 2n, …, and
//! `lab merge` puts the rows of all shards into the order of their runs: the bytes of the study that was not split.

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
