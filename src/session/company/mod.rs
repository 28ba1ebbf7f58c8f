//! The company of a run in memory: the simulation, what has happened so far, and its words. No files, no lines, no permission.

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
