//! Studies of policies by scenarios, parameters and seeds, optionally split into shards (docs/laboratory/study.md).
//!
//! A study file defines numbered runs. Shard i of n plays the runs i, i + n, i + 2n, …, and `lab merge` writes the
//! rows of all shards in the order of the runs. The merged file equals the output of the unsplit study.

mod definition;
mod grid;
mod merge;
mod shard;
mod summary;
mod table;
#[cfg(test)]
mod tests;

pub use definition::StudyPlan;
pub use merge::{MergeError, ShardSet};
pub use shard::{Shard, ShardHeader, parse_shard};
pub use summary::{describe_size, equal_arm_warnings, equal_outcome_warnings, study_summary};
pub use table::{column_names, rows};
