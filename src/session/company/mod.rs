//! The company of a run in memory: simulation, history and texts. This module does not use files, records or
//! permissions.

pub(crate) mod facts_chain;
pub(crate) mod feed;
pub(crate) mod hidden_state;
pub(crate) mod history;
pub(crate) mod idempotency;
pub(crate) mod irrevocable;
pub(crate) mod notices;
pub(crate) mod overrides;
pub(crate) mod post_judging;
pub(crate) mod reports;
pub(crate) mod run_context;
pub(crate) mod simulation;
pub(crate) mod week_actions;
