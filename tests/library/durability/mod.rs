//! Durability of confirmed actions: runs that are closed, killed, damaged or lose power are opened again.

mod damage;
mod kill;
mod property;
mod random_play;
mod recorded;
mod resume;
pub mod run;
mod sealed;
