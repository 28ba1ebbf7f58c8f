//! The laboratory: policies, experiments over many seeds, and comparison with reference figures.
//!
//! A policy uses only what a player can see, except for the channel choice of the paper's baseline, which reads
//! the starting yields from the parameters. Figures include hidden state, so policy runs are debug runs.

pub mod ablation;
mod answers;
pub mod baseline;
pub mod behaviour;
pub mod bench;
pub mod bound;
pub mod comparison;
pub mod consistency;
pub mod curves;
#[cfg(test)]
mod example_tests;
pub mod exhibit;
pub mod experiment;
mod forecasts;
mod golden;
pub mod laws;
mod lesson_check;
mod metrics;
mod normal;
mod opponents;
mod policy;
mod ranks;
pub mod results;
mod routine;
mod runner;
mod seeds;
mod strong;
pub mod study;
mod symbols;

pub use answers::{EnterpriseRule, OfferingRule, PriceFactor, ThreadTypes};
pub use forecasts::{PlayedWeeks, coverage, horizons, measure, play_weeks, policies_of};
pub use golden::{GoldenComparison, GoldenError, Reference, compare, read_reference};
pub use lesson_check::{
    FigureResult, GoalResult, LessonCheck, PlayResult, TOLERANCE, check_lesson, check_plays,
};
pub use metrics::{Collector, Figure};
pub use novamind_rules::answers_to_companies;
pub use novamind_world::params::Params;
pub use opponents::play_opponents;
pub use policy::{Policy, PolicyError};
pub use runner::{Outcome, RunEnd, RunError, RunSpec, play};
pub use seeds::{Seeds, parse_seeds};
pub use strong::STRONG;
