//! Actions of a student in a lesson: reading the lesson page, answering questions, requesting hints, retrying steps,
//! starting parts and reading the debrief.

pub(crate) mod answers;
pub(crate) mod debrief;
pub(crate) mod decisions;
pub(crate) mod runs;
pub(crate) mod status;
