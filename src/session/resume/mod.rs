//! Runs on the disk that are not simply continued: branches, damaged runs, verification, the database of a run that nobody plays.

pub(crate) mod branch;
pub(crate) mod look;
pub(crate) mod rebuild;
pub(crate) mod recorded;
pub(crate) mod rescue;
pub(crate) mod unnamed;
pub(crate) mod verify;

#[cfg(test)]
mod power_cut_tests;
