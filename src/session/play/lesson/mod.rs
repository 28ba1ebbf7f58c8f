//! What a lesson does in a run: it plays its start, begins and judges steps, and plays its reference plays in memory.
//!
//! What lessons are is in `novamind-record`; pages, answers and debriefs are
//! in `novamind-course`.

mod beginning;
pub(crate) mod conduct;
pub(crate) mod judging;
pub(crate) mod reference;
