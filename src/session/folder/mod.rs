//! The folder of runs: what a run is, how one begins, what is kept of it, and where scenarios, consent and queries lie.

pub(in crate::session) mod agreement;
pub(in crate::session) mod baseline;
pub(in crate::session) mod configuration;
pub(in crate::session) mod consent;
pub(in crate::session) mod create;
pub(in crate::session) mod derived;
pub(in crate::session) mod durable;
pub(in crate::session) mod first_line;
pub mod library;
pub(in crate::session) mod lock;
pub(in crate::session) mod manifest;
pub(in crate::session) mod mode;
pub(in crate::session) mod preview;
pub(in crate::session) mod runs;
