//! Durability of confirmed actions: runs that are closed, killed, damaged, or lose power, and are opened again.

mod damage;
mod games;
mod kill;
mod property;
mod recorded;
mod resume;
pub mod run;
mod sealed;
