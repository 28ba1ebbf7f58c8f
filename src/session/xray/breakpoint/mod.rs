//! Breakpoints: conditions on the figures of a day at which a debug run stops, and since when they hold in any run that
//! may be looked into (docs/debugging.md#breakpoints).

pub(in crate::session) mod condition;
pub(in crate::session) mod grammar;
pub(in crate::session) mod list;
pub(in crate::session) mod look_back;
pub(in crate::session) mod measure;
pub(in crate::session) mod run;
pub(in crate::session) mod series;
