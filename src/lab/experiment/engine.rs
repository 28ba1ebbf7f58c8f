//! The engine of experiments. The engine plays all runs that have no stored result in parallel, until the
//! experiment is complete or stopped.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use rayon::prelude::*;

use super::key::ArmKey;
use super::result::RunRecorder;
use super::{Arm, Experiment, ResultStore, RunResult};
use crate::runner::{self, RunError, RunSpec};
use novamind_record::folder::configuration::Configuration;
use novamind_session::DayReport;

/// The resources that an experiment uses.
pub struct ExperimentContext<'a> {
    /// Configuration with the scenarios and parameters.
    pub configuration: &'a Configuration,
    /// Store of results; `None` if results are not stored.
    pub store: Option<&'a ResultStore>,
    /// Thread pool that plays the runs.
    pub pool: &'a rayon::ThreadPool,
    /// Flag that stops the experiment. Active runs are abandoned.
    pub stop: &'a AtomicBool,
    /// Callback that is called after every played run.
    pub on_run: &'a (dyn Fn() + Sync),
}

/// The reason why an experiment has no results.
#[derive(Debug)]
pub enum ExperimentError {
    /// A run could not start, or a tool rejected a call.
    Run {
        /// Name of the arm whose run failed.
        arm: String,
        /// Error of the failed run.
        error: Box<RunError>,
    },
    /// Results cannot be stored or read.
    Store {
        /// Path of the results file.
        path: std::path::PathBuf,
        /// File system error.
        error: io::Error,
    },
    /// The experiment was stopped.
    Stopped {
        /// Number of runs whose results are stored.
        kept: usize,
        /// Total number of runs in the experiment.
        of: usize,
    },
}

impl fmt::Display for ExperimentError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ExperimentError::Run { arm, error } => write!(formatter, "{arm}: {error}"),
            ExperimentError::Store { path, error } => write!(
                formatter,
                "{}: {error}. Earlier results are safe. Run the same command again once the file can be written",
                path.display()
            ),
            ExperimentError::Stopped { kept, of } => {
                write!(formatter, "stopped: {kept} of {of} runs are stored; repeat the command to resume")
            }
        }
    }
}

impl std::error::Error for ExperimentError {}

/// The results of an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct ExperimentResults {
    /// Seeds of the runs, in the order of the experiment.
    pub seeds: Vec<u64>,
    /// Results of the runs, by arm and seed.
    pub by_arm: Vec<Vec<RunResult>>,
}

impl ExperimentResults {
    /// Returns the values of a figure in an arm, by seed.
    pub fn figures_of_arm(&self, arm: usize, figure: impl Fn(&RunResult) -> f64) -> Vec<f64> {
        self.by_arm.get(arm).into_iter().flatten().map(figure).collect()
    }

    /// Returns pairs of values of a figure in two arms, by seed.
    pub fn paired_figures(
        &self,
        arm: usize,
        other: usize,
        figure: impl Fn(&RunResult) -> f64,
    ) -> Vec<(f64, f64)> {
        self.figures_of_arm(arm, &figure).into_iter().zip(self.figures_of_arm(other, &figure)).collect()
    }
}

/// An experiment whose stored results are loaded.
pub struct PreparedExperiment<'a> {
    experiment: &'a Experiment,
    /// Keys of the runs by run number. Runs are numbered by arm, then by seed.
    keys: Vec<String>,
    /// Cash on day 0, dollars, by arm.
    start_cash: Vec<f64>,
    known_results: BTreeMap<String, RunResult>,
}

impl Experiment {
    /// Loads the stored results of the experiment, or no results if `fresh` is set.
    ///
    /// # Errors
    /// Fails if an arm has an unknown scenario or an invalid parameter, or if results cannot be read.
    pub fn prepare(
        &self,
        configuration: &Configuration,
        store: Option<&ResultStore>,
        fresh: bool,
    ) -> Result<PreparedExperiment<'_>, ExperimentError> {
        let arms = self.arm_keys(configuration)?;
        let keys = self.keys_of_arms(&arms);
        let start_cash = arms.iter().map(|arm| arm.start_cash).collect();
        let known = match store.filter(|_| !fresh) {
            None => BTreeMap::new(),
            Some(store) => {
                let all: BTreeSet<&str> = keys.iter().map(String::as_str).collect();
                store.load(&all).map_err(|error| to_experiment_error(store, error))?
            }
        };
        Ok(PreparedExperiment { experiment: self, keys, start_cash, known_results: known })
    }

    /// Returns the key of each run, by run number. A key covers everything on which the result depends.
    ///
    /// # Errors
    /// Fails if an arm has an unknown scenario or an invalid parameter.
    pub fn run_keys(&self, configuration: &Configuration) -> Result<Vec<String>, ExperimentError> {
        Ok(self.keys_of_arms(&self.arm_keys(configuration)?))
    }

    fn keys_of_arms(&self, arms: &[ArmKey]) -> Vec<String> {
        arms.iter().flat_map(|arm| self.seeds.iter().map(|seed| arm.run_key(*seed))).collect()
    }

    fn arm_keys(&self, configuration: &Configuration) -> Result<Vec<ArmKey>, ExperimentError> {
        let key = |arm: &Arm| {
            ArmKey::new(arm, &self.recorded, configuration).map_err(|error| ExperimentError::Run {
                arm: arm.name.clone(),
                error: Box::new(error.into()),
            })
        };
        self.arms.iter().map(key).collect()
    }
}

fn to_experiment_error(store: &ResultStore, error: io::Error) -> ExperimentError {
    ExperimentError::Store { path: store.path().to_owned(), error }
}

impl PreparedExperiment<'_> {
    /// Returns how many of the runs with the given numbers have no result.
    pub fn remaining_runs(&self, numbers: &[usize]) -> usize {
        self.pending_runs(numbers).len()
    }

    /// Adds `run` as the result of an arm's run with the same seed. The caller must ensure that the two runs
    /// are identical.
    pub fn add_result(&mut self, arm: usize, run: &RunResult) {
        let seeds = &self.experiment.seeds;
        let place = seeds.iter().position(|seed| *seed == run.seed);
        if let Some(key) = place.and_then(|place| self.keys.get(arm * seeds.len() + place)) {
            self.known_results.entry(key.clone()).or_insert_with(|| run.clone());
        }
    }

    /// Returns the numbers of the runs that must be played, without duplicates.
    fn pending_runs(&self, numbers: &[usize]) -> Vec<usize> {
        let mut taken = BTreeSet::new();
        let is_left = |number: &&usize| {
            let key = &self.keys[**number];
            !self.known_results.contains_key(key) && taken.insert(key)
        };
        numbers.iter().filter(is_left).copied().collect()
    }

    /// Returns the numbers of all runs of the experiment.
    pub fn run_numbers(&self) -> Vec<usize> {
        (0..self.keys.len()).collect()
    }

    /// Plays the remaining runs and returns all results.
    ///
    /// # Errors
    /// Fails if a run cannot be played, if a result cannot be stored, or if the experiment is stopped.
    /// Earlier results remain stored.
    pub fn run(self, with: &ExperimentContext<'_>) -> Result<ExperimentResults, ExperimentError> {
        let (seeds, arms) = (self.experiment.seeds.clone(), self.experiment.arms.len());
        let all = self.run_numbers();
        let mut results = self.run_numbered(&all, with)?.into_iter();
        let by_arm = (0..arms).map(|_| results.by_ref().take(seeds.len()).collect()).collect();
        Ok(ExperimentResults { seeds, by_arm })
    }

    /// Plays the runs among `numbers` that have no result. Returns the results of all `numbers` in the given order.
    ///
    /// # Errors
    /// Same errors as [`PreparedExperiment::run`].
    pub fn run_numbered(
        mut self,
        numbers: &[usize],
        with: &ExperimentContext<'_>,
    ) -> Result<Vec<RunResult>, ExperimentError> {
        let left = self.pending_runs(numbers);
        let before =
            numbers.iter().filter(|number| self.known_results.contains_key(&self.keys[**number])).count();
        let played = AtomicUsize::new(0);
        let one = |number: usize| {
            let Some(result) = self.play_run(number, with)? else { return Ok(None) };
            if let Some(store) = with.store {
                store
                    .append_result(&self.keys[number], &result)
                    .map_err(|error| to_experiment_error(store, error))?;
            }
            played.fetch_add(1, Ordering::Relaxed);
            (with.on_run)();
            Ok(Some((number, result)))
        };
        let found: Vec<Result<Option<(usize, RunResult)>, ExperimentError>> =
            with.pool.install(|| left.into_par_iter().with_max_len(1).map(one).collect());
        let kept = if with.store.is_some() { before + played.into_inner() } else { 0 };
        for outcome in found {
            match outcome? {
                Some((number, result)) => self.known_results.insert(self.keys[number].clone(), result),
                None => return Err(ExperimentError::Stopped { kept, of: numbers.len() }),
            };
        }
        Ok(numbers.iter().filter_map(|number| self.known_results.get(&self.keys[*number]).cloned()).collect())
    }

    /// Plays a run. Returns `None` if the experiment was stopped.
    fn play_run(
        &self,
        number: usize,
        with: &ExperimentContext<'_>,
    ) -> Result<Option<RunResult>, ExperimentError> {
        let seeds = &self.experiment.seeds;
        let (at, seed) = (number / seeds.len(), seeds[number % seeds.len()]);
        let arm = &self.experiment.arms[at];
        let goes_on = || !with.stop.load(Ordering::Relaxed);
        if !goes_on() {
            return Ok(None);
        }
        let spec = RunSpec { seed, save_folder: None, saves_database: false, ..arm.spec.clone() };
        let mut watch = RunRecorder::new(&self.experiment.recorded, self.start_cash[at]);
        let mut day = |report: &DayReport<'_>| watch.add_day(report);
        let session = runner::play_while(&goes_on, &arm.policy, &spec, with.configuration, &mut day)
            .map_err(|error| ExperimentError::Run { arm: arm.name.clone(), error: Box::new(error) })?;
        let outcome = runner::policy_outcome(&arm.policy, seed, &session, Duration::ZERO);
        Ok(runner::is_over(&session, &spec).then(|| watch.into_result(outcome, session.weeks())))
    }
}
