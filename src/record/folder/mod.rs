//! The folder of runs: manifests, locks, lists and previews, and the configuration with scenarios, consent and queries.

pub mod configuration;
pub mod derived;
pub mod library;
pub mod lock;
pub mod manifest;
pub mod preview;
pub mod runs;
