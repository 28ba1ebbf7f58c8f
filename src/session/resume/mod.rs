//! Opening a run again: from its snapshot or its trajectory, whole, damaged or as a branch, and what vouches for it.

pub(in crate::session) mod branch;
pub(in crate::session) mod integrity;
pub(in crate::session) mod look;
pub(in crate::session) mod mend;
pub(in crate::session) mod open;
pub(in crate::session) mod rebuild;
pub(in crate::session) mod rescue;
pub(in crate::session) mod sealing;
pub(in crate::session) mod snapshot;
pub(in crate::session) mod unnamed;
pub(in crate::session) mod verify;

#[cfg(test)]
mod power_cut_tests;
