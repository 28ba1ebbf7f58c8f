//! Lessons in a run: the start of a lesson, the evaluation of steps, and reference plays in memory.
//!
//! The definition of lessons is in `novamind-record`; pages, answers and debriefs are in `novamind-course`.

pub(crate) mod judging;
pub(crate) mod progress;
pub(crate) mod reference;
mod start;
