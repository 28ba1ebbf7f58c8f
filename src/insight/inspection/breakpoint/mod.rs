//! Breakpoints: conditions on daily figures that stop a debug run, and their history in any run that may be inspected
//! (docs/debugging.md#breakpoints).

pub(crate) mod condition;
pub(crate) mod condition_history;
pub(crate) mod grammar;
pub(crate) mod list;
pub(crate) mod measure;
pub(crate) mod measured_days;
pub(crate) mod run_until;
