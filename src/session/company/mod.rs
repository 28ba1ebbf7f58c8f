//! The company of a run in memory: simulation, history and texts. This layer knows no files, records or permissions.

pub(crate) mod facts_chain;
pub(crate) mod feed;
pub(crate) mod first_answers;
pub(crate) mod history;
pub(crate) mod irrevocable;
pub(crate) mod judging;
pub(crate) mod notices;
pub(crate) mod overrides;
pub(crate) mod reports;
pub(crate) mod simulation;
pub(crate) mod surroundings;
pub(crate) mod this_week;
pub(crate) mod xray;
