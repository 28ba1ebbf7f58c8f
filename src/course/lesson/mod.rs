//! A lesson as its student meets it: the page, answers and hints, further tries and parts, the debrief.

pub(crate) mod answers;
pub(crate) mod debrief;
pub(crate) mod decisions;
pub(crate) mod page;
pub(crate) mod runs;
