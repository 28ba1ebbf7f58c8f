//! Studies with people: what of a study stands in a run.

pub mod rules;
pub mod stamp;
