//! The student's side of a lesson: page, answers and hints, further tries and parts, debrief.

pub(crate) mod answers;
pub(crate) mod debrief;
pub(crate) mod decisions;
pub(crate) mod runs;
pub(crate) mod status;
