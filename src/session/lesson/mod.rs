//! Lessons: what an instructor lays down, and a student's way through it (docs/lessons/authors-guide.md).
//!
//! A lesson has parts, each a company of its own that is recorded as a run; a part has steps of some weeks, with a question
//! before they run, goals, and hints. What a student did in it are lines of kind `lesson`. A reference play makes its calls
//! through the same doors, in memory.

mod again;
mod beginning;
pub(in crate::session) mod conduct;
pub(in crate::session) mod debrief;
pub(in crate::session) mod decisions;
pub(in crate::session) mod definition;
pub(in crate::session) mod lesson_call;
pub(in crate::session) mod lesson_file;
mod measure;
pub(in crate::session) mod measurement;
pub(in crate::session) mod over;
pub(in crate::session) mod page;
pub(in crate::session) mod reference;
pub(in crate::session) mod shelf;
pub(in crate::session) mod soundness;
pub(in crate::session) mod stamp;
pub(in crate::session) mod standing;
#[cfg(test)]
mod tests;
