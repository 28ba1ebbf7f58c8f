//! The folder of runs: what a run is, how one begins, what is kept of it, and where scenarios, consent and queries lie.

pub(crate) mod agreement;
pub(crate) mod baseline;
pub(crate) mod configuration;
pub(crate) mod consent;
pub(crate) mod create;
pub(crate) mod derived;
pub(crate) mod durable;
pub(crate) mod first_line;
pub mod library;
pub(crate) mod lock;
pub(crate) mod manifest;
pub(crate) mod mode;
pub(crate) mod preview;
pub(crate) mod runs;
