//! The simulator: pure and deterministic, without I/O, clock, SQL or text output.
//!
//! [`day::step_day_observed`] lists the steps of a day and is the place to start reading. Each mechanism is a function
//! of the state that it changes. Each formula is a small pure function whose tests contain check values
//! (`docs/mechanics/README.md`).
//!
//! Modules from bottom to top: `identifiers`, `random`, `canonical`, `fault`, `params`; `quality`, `reputation`,
//! `quota`, `series`; `settings`, `customers`; `events`, `morning`; `product`; `context`, `finance`; `retention`;
//! `enterprise`; `market`; `fixed_inputs`, `state`; `command`, `day`.

pub mod canonical;
pub mod command;
pub mod context;
pub mod customers;
pub mod day;
pub mod enterprise;
pub mod events;
pub mod fault;
mod finance;
pub mod fixed_inputs;
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

/// Version of the mechanics. The version increases with every change after which the same decisions can lead to a
/// different state. The program rejects runs of earlier versions and states the reason.
pub const MECHANICS: u32 = 1;
