//! Counterfactuals: re-simulates days of a run in memory with edits and the same random draws.
//!
//! Random streams are keyed by their purpose, so an edit does not change the draws of other mechanisms. A
//! re-simulation needs no database, trajectory or notifications. The input is a
//! [`MemorySnapshot`](memory_snapshot::MemorySnapshot) of the run, the [`RecordedStep`](recorded_steps::RecordedStep)s
//! after the snapshot, and [`Edits`](edits::Edits). The output is a set of figures.

pub(crate) mod analysis_cache;
pub(crate) mod branch;
pub(crate) mod customer_renumbering;
pub(crate) mod due_bills;
pub(crate) mod edits;
pub(crate) mod memory_snapshot;
pub(crate) mod parallel_map;
pub(crate) mod recorded_run;
pub(crate) mod recorded_steps;
pub(crate) mod suspended_setting;
#[cfg(test)]
pub(crate) mod test_kit;
#[cfg(test)]
mod tests;
