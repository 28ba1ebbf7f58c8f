//! Breakpoints: conditions on the figures of a day at which a debug run stops, and since when they hold in any run that
//! may be looked into (docs/debugging.md#breakpoints).

pub(crate) mod condition;
pub(crate) mod grammar;
pub(crate) mod list;
pub(crate) mod look_back;
pub(crate) mod measure;
pub(crate) mod run;
pub(crate) mod series;
