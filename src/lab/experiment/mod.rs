//! Experiments: several arms, each with a policy, are played on the same seeds in parallel. Each result is stored as
//! soon as its run ends.
//!
//! [`Experiment::prepare`] loads results of earlier commands. [`PreparedExperiment::run`] plays the remaining runs. If
//! a stopped command is repeated, the experiment resumes. The output then equals the output of an uninterrupted
//! command.

mod engine;
mod key;
mod result;
mod store;
#[cfg(test)]
pub(super) mod test_kit;
#[cfg(test)]
mod tests;

pub use engine::{ExperimentContext, ExperimentError, ExperimentResults, PreparedExperiment};
pub use result::{DayPoint, FigurePoint, RunResult, WeekPoint};
pub use store::ResultStore;

use std::collections::BTreeMap;

use key::ArmKey;

use super::policy::Policy;
use super::runner::{RunSpec, new_run};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_world::params::{Horizon, Params};

/// An arm: one condition of an experiment.
#[derive(Debug, Clone)]
pub struct Arm {
    /// Name that tables show for the arm.
    pub name: String,
    /// Policy that plays the arm.
    pub policy: Policy,
    /// Conditions of the runs: scenario, overrides, days and cash. The seed is ignored.
    pub spec: RunSpec,
}

impl Arm {
    /// Creates an arm with the settings of the policy file.
    pub fn new(name: impl Into<String>, policy: Policy) -> Arm {
        Arm { name: name.into(), policy, spec: RunSpec::for_seed(0) }
    }

    /// Returns the horizon, the cash on day 0 in dollars, and the parameters of the arm's runs.
    ///
    /// # Errors
    /// Fails if the scenario is unknown or a parameter is invalid.
    pub fn run_conditions(&self, configuration: &Configuration) -> Result<(Horizon, f64, Params), RunError> {
        let run = new_run(&self.policy, &self.spec);
        let scenario = configuration.load_scenario(&run.scenario)?;
        let params = configuration.load_parameters(&scenario, &run.overrides, true)?;
        let (days, cash) = scenario.days_and_cash_with(&params);
        let horizon = params.run.horizon(run.days.unwrap_or(days));
        Ok((horizon, run.cash.unwrap_or(cash), params))
    }
}

/// The figures that are stored for each run in addition to its end and its weeks.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RecordedFigures {
    /// Whether to store figures for each day.
    pub daily: bool,
    /// Days for which all figures are stored, including hidden figures (docs/interfaces/golden.md#figures).
    pub figures_on: Vec<u32>,
}

/// An experiment: arms and their common seeds.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Arms of the experiment, in display order.
    pub arms: Vec<Arm>,
    /// Seeds that every arm plays.
    pub seeds: Vec<u64>,
    /// Additional figures to store for each run.
    pub recorded: RecordedFigures,
}

impl Experiment {
    /// Creates an experiment that stores the end and the weeks of each run.
    pub fn new(arms: Vec<Arm>, seeds: impl IntoIterator<Item = u64>) -> Experiment {
        Experiment { arms, seeds: seeds.into_iter().collect(), recorded: RecordedFigures::default() }
    }

    /// Returns groups of two or more arms with the same policy, parameters, days and cash.
    ///
    /// # Errors
    /// Fails if the scenario is unknown or a parameter is invalid.
    pub fn find_equal_arms(&self, configuration: &Configuration) -> Result<Vec<Vec<usize>>, RunError> {
        let key = |arm: &Arm| Ok(ArmKey::new(arm, &self.recorded, configuration)?.run_key(0));
        Ok(group_equal_items(self.arms.iter().map(key).collect::<Result<Vec<String>, RunError>>()?))
    }
}

/// Returns groups of two or more indices whose items are equal.
pub fn group_equal_items<T: Ord>(items: Vec<T>) -> Vec<Vec<usize>> {
    let mut places: BTreeMap<T, Vec<usize>> = BTreeMap::new();
    items.into_iter().enumerate().for_each(|(at, item)| places.entry(item).or_default().push(at));
    let mut groups: Vec<Vec<usize>> = places.into_values().filter(|numbers| numbers.len() > 1).collect();
    groups.sort_unstable();
    groups
}
