//! The runs folder with manifests, locks, run lists and previews, and the configuration with scenarios, consent and
//! queries.

pub mod configuration;
pub mod lock;
pub mod manifest;
pub mod manifest_check;
pub mod preview;
pub mod query_library;
pub mod runs;
