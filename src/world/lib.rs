//! The simulator: pure, deterministic, without input or output, clock, SQL or prose.
//!
//! Read [`day::step_day`] first: it is the story of a day. Every mechanism it calls is a function over the parts
//! it touches, and every formula a small pure function with check values as its test (`docs/mechanics/README.md`).
//!
//! Modules from bottom to top: `identifiers`, `random`, `canonical`, `fault`, `params`; `quality`, `reputation`, `quota`, `series`;
//! `settings`, `customers`; `events`, `morning`; `product`; `context`, `finance`; `retention`; `enterprise`; `market`; `held`,
//! `state`; `command`, `day`.

pub mod canonical;
pub mod command;
pub mod context;
pub mod customers;
pub mod day;
pub mod enterprise;
pub mod events;
pub mod fault;
mod finance;
pub mod held;
pub mod identifiers;
pub mod market;
pub mod morning;
pub mod params;
pub mod product;
pub mod quality;
pub mod quota;
pub mod random;
pub mod reputation;
pub mod retention;
mod series;
pub mod settings;
pub mod state;
#[cfg(any(test, feature = "test-kit"))]
pub mod test_kit;

/// Number of the mechanics. It rises with every change after which the same decisions can lead to another state, so
/// that runs of earlier builds are refused with a reason instead of differing somewhere.
pub const MECHANICS: u32 = 1;
