//! What was confirmed stays: runs that are left, killed, cut off from power, damaged, and taken up again.

mod damage;
mod games;
mod kill;
mod property;
mod recorded;
mod resume;
pub mod run;
mod sealed;
