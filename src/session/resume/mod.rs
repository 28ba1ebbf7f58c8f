//! Operations on stored runs: branches, recovery, verification and rebuilding of databases.

pub(crate) mod branch;
pub(crate) mod external_read;
pub(crate) mod origin;
pub(crate) mod rebuild;
pub(crate) mod recovery;
pub(crate) mod staged_branch;
pub(crate) mod verify;

#[cfg(test)]
mod power_cut_tests;
