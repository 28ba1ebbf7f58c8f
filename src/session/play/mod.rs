//! Playing a run: calls and weeks, what follows from them, and taking them back.

pub(in crate::session) mod act;
pub(in crate::session) mod advance;
pub(in crate::session) mod afterwards;
pub(in crate::session) mod clock;
pub(in crate::session) mod drafts;
pub(in crate::session) mod entry;
pub(in crate::session) mod facts_chain;
pub(in crate::session) mod feed;
pub(in crate::session) mod history;
pub(in crate::session) mod irrevocable;
pub(in crate::session) mod judging;
pub(in crate::session) mod machine;
pub(in crate::session) mod memo;
pub(in crate::session) mod once;
pub(in crate::session) mod overrides;
pub(in crate::session) mod parameters;
pub(in crate::session) mod personal_clock;
pub(in crate::session) mod presence;
pub(in crate::session) mod projection;
pub(in crate::session) mod recorder;
pub(in crate::session) mod recording;
pub(in crate::session) mod scripts;
pub(in crate::session) mod simulation;
pub(in crate::session) mod surroundings;
pub(in crate::session) mod this_week;
pub(in crate::session) mod undo;
