//! Plays what is not known yet, on all threads, until all is done or somebody stops it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use rayon::prelude::*;

use super::key::ArmKey;
use super::result::DayWatch;
use super::{Arm, Experiment, ResultStore, RunResult};
use crate::lab::runner::{self, RunError, RunSpec};
use crate::session::{Configuration, DayReport};

/// What an experiment is conducted with.
pub struct Conduct<'a> {
    /// Scenarios and parameters.
    pub configuration: &'a Configuration,
    /// Where results are kept; none: nowhere.
    pub store: Option<&'a ResultStore>,
    /// Threads.
    pub pool: &'a rayon::ThreadPool,
    /// Set from outside to stop: runs under way are given up.
    pub stop: &'a AtomicBool,
    /// Told after every run that was played.
    pub on_run: &'a (dyn Fn() + Sync),
}

/// Why an experiment has no results yet.
#[derive(Debug)]
pub enum ExperimentError {
    /// A run cannot begin, or a tool refused a call.
    Run {
        /// Arm.
        arm: String,
        /// What happened.
        error: RunError,
    },
    /// Results cannot be kept or read.
    Store {
        /// The file.
        path: std::path::PathBuf,
        /// What the disk says.
        error: io::Error,
    },
    /// Somebody stopped it.
    Stopped {
        /// Runs that are kept.
        kept: usize,
        /// Runs of the experiment.
        of: usize,
    },
}

impl fmt::Display for ExperimentError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ExperimentError::Run { arm, error } => write!(formatter, "{arm}: {error}"),
            ExperimentError::Store { path, error } => write!(
                formatter,
                "{}: {error}; what was kept before is safe, and the same command goes on once the file can be written",
                path.display()
            ),
            ExperimentError::Stopped { kept, of } => {
                write!(formatter, "stopped: {kept} of {of} runs are kept, and the same command goes on")
            }
        }
    }
}

impl std::error::Error for ExperimentError {}

/// The results of an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct ExperimentResults {
    /// Seeds, in the order of the experiment.
    pub seeds: Vec<u64>,
    /// Results by arm and seed.
    pub by_arm: Vec<Vec<RunResult>>,
}

impl ExperimentResults {
    /// A figure of the runs of an arm, by seed.
    pub fn of(&self, arm: usize, figure: impl Fn(&RunResult) -> f64) -> Vec<f64> {
        self.by_arm.get(arm).into_iter().flatten().map(figure).collect()
    }

    /// A figure of an arm and of another under the same luck, seed by seed.
    pub fn pairs(&self, arm: usize, other: usize, figure: impl Fn(&RunResult) -> f64) -> Vec<(f64, f64)> {
        self.of(arm, &figure).into_iter().zip(self.of(other, &figure)).collect()
    }
}

/// An experiment of which it is known what is left to play.
pub struct Prepared<'a> {
    experiment: &'a Experiment,
    /// Keys by arm and seed.
    keys: Vec<Vec<String>>,
    known: BTreeMap<String, RunResult>,
}

impl Experiment {
    /// Finds what is known already; nothing, if it is to be played afresh.
    ///
    /// # Errors
    /// An arm has no such scenario or a wrong parameter; the results cannot be read.
    pub fn prepare(
        &self,
        configuration: &Configuration,
        store: Option<&ResultStore>,
        fresh: bool,
    ) -> Result<Prepared<'_>, ExperimentError> {
        let keys_of = |arm: &Arm| -> Result<Vec<String>, ExperimentError> {
            let key = ArmKey::of(arm, &self.wanted, configuration).map_err(|error| ExperimentError::Run {
                arm: arm.name.clone(),
                error: RunError::Start(error),
            })?;
            Ok(self.seeds.iter().map(|seed| key.of_seed(*seed)).collect())
        };
        let keys: Vec<Vec<String>> = self.arms.iter().map(keys_of).collect::<Result<_, _>>()?;
        let known = match store.filter(|_| !fresh) {
            None => BTreeMap::new(),
            Some(store) => {
                let all: BTreeSet<String> = keys.iter().flatten().cloned().collect();
                store.known(&all).map_err(|error| in_store(store, error))?
            }
        };
        Ok(Prepared { experiment: self, keys, known })
    }
}

fn in_store(store: &ResultStore, error: io::Error) -> ExperimentError {
    ExperimentError::Store { path: store.path().to_owned(), error }
}

impl Prepared<'_> {
    /// Runs that are still to be played.
    pub fn left(&self) -> usize {
        self.to_play().len()
    }

    /// Each run that is to be played once, by its key: arm and seed.
    fn to_play(&self) -> BTreeMap<&str, (usize, u64)> {
        let mut left = BTreeMap::new();
        for (arm, keys) in self.keys.iter().enumerate() {
            for (key, seed) in keys.iter().zip(&self.experiment.seeds) {
                if !self.known.contains_key(key) {
                    left.entry(key.as_str()).or_insert((arm, *seed));
                }
            }
        }
        left
    }

    /// Plays what is left, and gives all results.
    ///
    /// # Errors
    /// A run cannot be played, a result cannot be kept, or somebody stopped it. What was played before is kept.
    pub fn conduct(mut self, with: &Conduct<'_>) -> Result<ExperimentResults, ExperimentError> {
        let mut left: Vec<(String, usize, u64)> =
            self.to_play().into_iter().map(|(key, (arm, seed))| (key.to_owned(), arm, seed)).collect();
        // The order in which they are shown.
        left.sort_by_key(|(_, arm, seed)| (*arm, *seed));
        let (of, before) = (self.keys.iter().map(Vec::len).sum(), self.known.len());
        let played = AtomicUsize::new(0);
        let one = |(key, arm, seed): (String, usize, u64)| {
            let result = play_one(&self.experiment.arms[arm], seed, self.experiment, with)?;
            let Some(result) = result else {
                let kept = if with.store.is_some() { before + played.load(Ordering::Relaxed) } else { 0 };
                return Err(ExperimentError::Stopped { kept, of });
            };
            if let Some(store) = with.store {
                store.keep(&key, &result).map_err(|error| in_store(store, error))?;
            }
            played.fetch_add(1, Ordering::Relaxed);
            (with.on_run)();
            Ok((key, result))
        };
        let found: Vec<Result<(String, RunResult), ExperimentError>> =
            with.pool.install(|| left.into_par_iter().with_max_len(1).map(one).collect());
        let kept = if with.store.is_some() { before + played.load(Ordering::Relaxed) } else { 0 };
        for own in found {
            match own {
                Ok((key, result)) => drop(self.known.insert(key, result)),
                // Runs that ended while others were given up count too.
                Err(ExperimentError::Stopped { of, .. }) => {
                    return Err(ExperimentError::Stopped { kept, of });
                }
                Err(error) => return Err(error),
            }
        }
        let of_key = |(key, seed): (&String, &u64)| {
            let mut own = self.known.get(key).cloned()?;
            own.seed = *seed;
            Some(own)
        };
        let of_arm =
            |keys: &Vec<String>| keys.iter().zip(&self.experiment.seeds).filter_map(of_key).collect();
        Ok(ExperimentResults {
            seeds: self.experiment.seeds.clone(),
            by_arm: self.keys.iter().map(of_arm).collect(),
        })
    }
}

/// A run; none if it was given up.
fn play_one(
    arm: &Arm,
    seed: u64,
    experiment: &Experiment,
    with: &Conduct<'_>,
) -> Result<Option<RunResult>, ExperimentError> {
    let goes_on = || !with.stop.load(Ordering::Relaxed);
    if !goes_on() {
        return Ok(None);
    }
    let spec = RunSpec { seed, save: None, projection: false, ..arm.spec.clone() };
    let mut watch = DayWatch::of(&experiment.wanted);
    let mut day = |report: &DayReport<'_>| watch.day(report);
    let session = runner::play_while(&goes_on, &arm.policy, &spec, with.configuration, &mut day)
        .map_err(|error| ExperimentError::Run { arm: arm.name.clone(), error })?;
    let outcome = runner::outcome(&arm.policy, seed, &session, Duration::ZERO);
    Ok(runner::is_over(&session, &spec).then(|| watch.result(outcome, session.weeks())))
}
