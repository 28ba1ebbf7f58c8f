//! Opening a run again: from its snapshot or its trajectory, whole, damaged or as a branch, and what vouches for it.

pub(crate) mod branch;
pub(crate) mod integrity;
pub(crate) mod look;
pub(crate) mod mend;
pub(crate) mod open;
pub(crate) mod rebuild;
pub(crate) mod rescue;
pub(crate) mod sealing;
pub(crate) mod snapshot;
pub(crate) mod unnamed;
pub(crate) mod verify;

#[cfg(test)]
mod power_cut_tests;
