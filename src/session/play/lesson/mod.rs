//! What a lesson does in a run: it plays its start, begins and judges steps, and plays its reference plays in memory.
//!
//! No other module of the session imports this one. What lessons are is in `novamind-record`; pages, answers and debriefs are
//! in `novamind-course`.

mod beginning;
mod conduct;
pub(crate) mod judging;
pub(crate) mod reference;
