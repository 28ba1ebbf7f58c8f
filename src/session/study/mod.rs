//! Studies with people: what an experimenter lays down, the way of a participant through it, and what of it stands in a run.

pub mod answer_book;
pub mod assignment;
pub mod code;
pub mod definition;
pub mod due;
pub mod gather;
pub(crate) mod keys;
pub mod questions;
pub mod remarks;
pub mod sittings;
pub(crate) mod tombstone;
pub mod visit;
pub mod visit_log;
