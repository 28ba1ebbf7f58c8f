//! The simulator: pure, deterministic, without input or output, clock, SQL or prose.
//!
//! Read [`day::step_day`] first: it is the story of a day. Every mechanism it calls is a function over the parts
//! it touches, and every formula a small pure function with check values as its test (`docs/mechanics/README.md`).

pub(crate) mod canonical;
pub(crate) mod command;
pub mod context;
pub mod customers;
pub mod day;
pub(crate) mod enterprise;
pub mod events;
mod finance;
pub mod identifiers;
pub(crate) mod market;
pub mod morning;
pub mod params;
pub mod product;
pub(crate) mod quota;
pub mod random;
pub mod retention;
mod series;
pub(crate) mod settings;
pub mod state;

/// Number of the mechanics. It rises with every change after which the same decisions can lead to another state, so
/// that runs of earlier builds are refused with a reason instead of differing somewhere.
pub const MECHANICS: u32 = 1;
