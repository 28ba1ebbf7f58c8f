//! The folder of runs: what a run is, how one begins, what is kept of it, and where scenarios, consent and queries lie.

pub mod configuration;
pub mod derived;
pub mod library;
pub mod lock;
pub mod manifest;
pub mod preview;
pub mod runs;
