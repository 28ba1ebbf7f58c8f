//! Operations on stored runs: branches, recovery, verification, rebuilding of databases.

pub(crate) mod branch;
pub(crate) mod look;
pub(crate) mod rebuild;
pub(crate) mod recorded;
pub(crate) mod rescue;
pub(crate) mod unnamed;
pub(crate) mod verify;

#[cfg(test)]
mod power_cut_tests;
