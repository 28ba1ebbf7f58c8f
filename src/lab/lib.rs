//! The laboratory: policies, experiments over many seeds, and comparison with golden figures.
//!
//! A policy uses only information that a player can see. The paper's baseline is an exception: it chooses
//! channels by the starting yields, which it reads from the parameters. The recorded figures include hidden
//! state, so policies play debug runs.

pub mod ablation;
pub mod baseline;
pub mod behavior;
pub mod benchmark;
pub mod bound;
pub mod comparison;
pub mod consistency;
pub mod curves;
pub mod distributions;
mod enterprise_answers;
pub mod experiment;
mod forecast_backtest;
mod golden_figures;
pub mod lab_report;
mod lesson_check;
mod metrics;
mod normal_distribution;
mod opponents;
mod policy;
mod random_settings;
mod ranks;
pub mod results;
mod runner;
mod seeds;
#[cfg(test)]
mod spoiler_tests;
mod strong_policies;
pub mod study;
mod symbols;
mod weekly_routine;

pub use enterprise_answers::{EnterpriseRule, OfferRule, PriceFactor, ThreadTypes};
pub use forecast_backtest::{
    CompanyForecasts, StageResult, backtest_policy, backtest_recorded_run, forecast_horizons,
    measure_intervals, stage_results,
};
pub use golden_figures::{
    GoldenComparison, GoldenError, ReferenceFigures, compare_with_reference, read_reference,
    read_reference_scenario,
};
pub use lesson_check::{
    FigureResult, GoalResult, LessonCheck, PlayResult, TOLERANCE, check_lesson, check_plays,
};
pub use metrics::{MetricValue, MetricsCollector};
pub use novamind_rules::calls_for_waiting_threads;
pub use novamind_world::params::Params;
pub use opponents::play_opponents;
pub use policy::{Policy, PolicyError};
pub use random_settings::random_policy;
pub use runner::{PolicyRunOutcome, RunEnd, RunError, RunSpec, play_policy};
pub use seeds::{SeedRange, parse_seeds};
pub use strong_policies::STRONG_POLICIES;
