//! The folder of runs: what a run is, how one begins, what is kept of it, and where scenarios, consent and queries lie.

pub mod configuration;
pub mod consent;
pub mod derived;
pub mod durable;
pub mod first_line;
pub mod library;
pub mod lock;
pub mod manifest;
pub mod mode;
pub mod preview;
pub mod runs;
