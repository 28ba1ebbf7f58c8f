//! Arms by seeds: policies played on the same seeds in parallel. Each result is stored as soon as its run ends.
//!
//! [`Experiment::prepare`] loads results of earlier commands, [`PreparedExperiment::run`] plays the rest. A command that was
//! stopped and is repeated resumes and prints the same output as an uninterrupted one.

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
use novamind_world::params::Params;

/// One condition of an experiment.
#[derive(Debug, Clone)]
pub struct Arm {
    /// Name in tables.
    pub name: String,
    /// Policy that plays.
    pub policy: Policy,
    /// Scenario, overrides, days and cash; the seed is ignored.
    pub spec: RunSpec,
}

impl Arm {
    /// Creates an arm with the settings of the policy file.
    pub fn new(name: impl Into<String>, policy: Policy) -> Arm {
        Arm { name: name.into(), policy, spec: RunSpec::for_seed(0) }
    }

    /// Returns the last day, the cash on day 0 in dollars, and the parameters of its runs.
    ///
    /// # Errors
    /// Fails if the scenario is unknown or a parameter is invalid.
    pub fn run_conditions(&self, configuration: &Configuration) -> Result<(u32, f64, Params), RunError> {
        let run = new_run(&self.policy, &self.spec);
        let scenario = configuration.load_scenario(&run.scenario)?;
        let params = configuration.load_parameters(&scenario, &run.overrides, true)?;
        let (days, cash) = scenario.days_and_cash_with(&params);
        Ok((run.days.unwrap_or(days), run.cash.unwrap_or(cash), params))
    }
}

/// Figures stored for each run in addition to its end and weeks.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RecordedFigures {
    /// Whether to store a point for each day.
    pub daily: bool,
    /// Days of which all figures are stored, including hidden ones (docs/interfaces/golden.md#figures).
    pub figures_on: Vec<u32>,
}

/// Arms and their common seeds.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Arms in display order.
    pub arms: Vec<Arm>,
    /// Seeds.
    pub seeds: Vec<u64>,
    /// Stored figures of each run.
    pub recorded: RecordedFigures,
}

impl Experiment {
    /// Creates an experiment that stores the end and the weeks of each run.
    pub fn new(arms: Vec<Arm>, seeds: impl IntoIterator<Item = u64>) -> Experiment {
        Experiment { arms, seeds: seeds.into_iter().collect(), recorded: RecordedFigures::default() }
    }

    /// Returns the arms that are played with the same policy, parameters, days and cash, in groups of two or more.
    ///
    /// # Errors
    /// Fails if the scenario is unknown or a parameter is invalid.
    pub fn equal_arms(&self, configuration: &Configuration) -> Result<Vec<Vec<usize>>, RunError> {
        let key = |arm: &Arm| Ok(ArmKey::new(arm, &self.recorded, configuration)?.run_key(0));
        Ok(groups_of_equal(self.arms.iter().map(key).collect::<Result<Vec<String>, RunError>>()?))
    }
}

/// Returns the indices of equal items in groups of two or more.
pub fn groups_of_equal<T: Ord>(items: Vec<T>) -> Vec<Vec<usize>> {
    let mut places: BTreeMap<T, Vec<usize>> = BTreeMap::new();
    items.into_iter().enumerate().for_each(|(at, item)| places.entry(item).or_default().push(at));
    let mut groups: Vec<Vec<usize>> = places.into_values().filter(|numbers| numbers.len() > 1).collect();
    groups.sort_unstable();
    groups
}
