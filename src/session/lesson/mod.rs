//! Lessons: what an instructor lays down, and a student's way through it (docs/lessons/authors-guide.md).
//!
//! A lesson has parts, each a company of its own that is recorded as a run; a part has steps of some weeks, with a question
//! before they run, goals, and hints. What a student did in it are lines of kind `lesson`. A reference play makes its calls
//! through the same doors, in memory.

mod again;
mod beginning;
pub(crate) mod conduct;
pub(crate) mod debrief;
pub(crate) mod decisions;
pub(crate) mod definition;
pub(crate) mod lesson_call;
pub(crate) mod lesson_file;
mod measure;
pub(crate) mod measurement;
pub(crate) mod over;
pub(crate) mod page;
pub(crate) mod reference;
pub(crate) mod soundness;
pub(crate) mod standing;
#[cfg(test)]
mod tests;
