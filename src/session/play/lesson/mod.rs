//! Lessons in a run: their start, the judgement of steps, and reference plays in memory.
//!
//! The definition of lessons is in `novamind-record`; pages, answers and debriefs are in `novamind-course`.

mod beginning;
pub(crate) mod conduct;
pub(crate) mod judging;
pub(crate) mod reference;
