//! Counterfactuals: re-simulates days of a run in memory with edits and the same random draws.
//!
//! Random streams are keyed by their purpose, so an edit does not change the draws of other mechanisms. A re-simulation needs no
//! database, trajectory or notices. Its input is a [`KeptState`](kept_state::KeptState) of the run, the [`Move`](script::Move)s that
//! follow it, and [`Edits`](edits::Edits); its output are figures.

pub(crate) mod branch;
pub(crate) mod companies;
pub(crate) mod edits;
pub(crate) mod kept_state;
pub(crate) mod last_read;
pub(crate) mod one_each;
pub(crate) mod past;
pub(crate) mod script;
#[cfg(test)]
pub(crate) mod test_kit;
#[cfg(test)]
mod tests;
