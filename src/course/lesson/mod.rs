//! What a student does in a lesson: read the lesson page, answer questions, request hints, retry steps, start parts
//! and read the debrief.

pub(crate) mod answers;
pub(crate) mod debrief;
pub(crate) mod decisions;
pub(crate) mod runs;
pub(crate) mod status;
