//! Arms by seeds: policies played under the same luck, in parallel, each run kept as soon as it is over.
//!
//! [`Experiment::prepare`] finds what earlier commands have kept, [`Prepared::conduct`] plays the rest. A command that is
//! stopped and given again goes on where it was, and shows what it would have shown at once.

mod engine;
mod key;
mod result;
mod store;
#[cfg(test)]
pub(super) mod test_kit;
#[cfg(test)]
mod tests;

pub use engine::{Conduct, ExperimentError, ExperimentResults, Prepared};
pub use result::{DayPoint, FigurePoint, RunResult, WeekPoint};
pub use store::ResultStore;

use std::collections::BTreeMap;

use key::ArmKey;

use super::policy::Policy;
use super::runner::{RunSpec, new_run};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_world::params::Params;

/// One way to play that is compared with others.
#[derive(Debug, Clone)]
pub struct Arm {
    /// Name in tables.
    pub name: String,
    /// What plays.
    pub policy: Policy,
    /// Scenario, overrides, days and cash; its seed is not used.
    pub spec: RunSpec,
}

impl Arm {
    /// A policy as its file says.
    pub fn new(name: impl Into<String>, policy: Policy) -> Arm {
        Arm { name: name.into(), policy, spec: RunSpec::of_seed(0) }
    }

    /// What its runs are played under: the last day, the cash on day 0 in dollars, and the parameters.
    ///
    /// # Errors
    /// There is no such scenario, or a parameter is wrong: its runs could not begin.
    pub fn terms(&self, configuration: &Configuration) -> Result<(u32, f64, Params), RunError> {
        let run = new_run(&self.policy, &self.spec);
        let scenario = configuration.scenario(&run.scenario)?;
        let params = configuration.parameters(&scenario, &run.overrides, true)?;
        let (days, cash) = scenario.terms(&params);
        Ok((run.days.unwrap_or(days), run.cash.unwrap_or(cash), params))
    }
}

/// What is kept of each run beside its end and its weeks.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Wanted {
    /// A point for each day.
    pub daily: bool,
    /// Days of which all figures are kept, hidden ones included (docs/interfaces/golden.md#figures).
    pub figures_on: Vec<u32>,
}

/// Arms and the seeds they have in common.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Arms, in the order in which they are shown.
    pub arms: Vec<Arm>,
    /// Seeds.
    pub seeds: Vec<u64>,
    /// What is kept of each run.
    pub wanted: Wanted,
}

impl Experiment {
    /// Arms over seeds; the end and the weeks of each run are kept.
    pub fn of(arms: Vec<Arm>, seeds: impl IntoIterator<Item = u64>) -> Experiment {
        Experiment { arms, seeds: seeds.into_iter().collect(), wanted: Wanted::default() }
    }

    /// Returns the arms that are played with the same policy, parameters, days and cash, in groups of two or more.
    ///
    /// # Errors
    /// There is no such scenario, or a parameter is wrong.
    pub fn equal_arms(&self, configuration: &Configuration) -> Result<Vec<Vec<usize>>, RunError> {
        let key = |arm: &Arm| Ok(ArmKey::of(arm, &self.wanted, configuration)?.of_seed(0));
        Ok(groups(self.arms.iter().map(key).collect::<Result<Vec<String>, RunError>>()?))
    }
}

/// Returns the places of equal items, in groups of two or more, in their order.
pub fn groups<T: Ord>(items: Vec<T>) -> Vec<Vec<usize>> {
    let mut places: BTreeMap<T, Vec<usize>> = BTreeMap::new();
    items.into_iter().enumerate().for_each(|(at, item)| places.entry(item).or_default().push(at));
    let mut groups: Vec<Vec<usize>> = places.into_values().filter(|own| own.len() > 1).collect();
    groups.sort_unstable();
    groups
}
