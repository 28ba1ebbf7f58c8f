//! Support for commands that run experiments: progress, ctrl-c, and the file with cached results.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::Args;

use crate::cli::run::{progress_bar, thread_pool};
use crate::cli::{Context, Failure};
use crate::lab::experiment::{
    Experiment, ExperimentContext, ExperimentError, ExperimentResults, PreparedExperiment, ResultStore,
    RunResult,
};

/// Options of commands that play many runs.
#[derive(Debug, Clone, Args)]
pub struct PlayOptions {
    /// Number of runs to play in parallel [default: the number of processors]
    #[arg(long, value_name = "N")]
    pub jobs: Option<usize>,
    /// Play every run again, even if its result is cached
    #[arg(long)]
    pub fresh: bool,
}

/// Conducts the experiment of a command. Results are cached under the name of the command, so that each run
/// is played only once.
///
/// # Errors
/// An arm cannot start, a run cannot be played, or the results cannot be written. Stopping the experiment is also an error.
pub fn run_experiment(
    command: &str,
    experiment: &Experiment,
    options: &PlayOptions,
    context: &Context,
) -> Result<ExperimentResults, Failure> {
    run_experiment_with_known_results(command, experiment, options, context, |_| ())
}

/// Conducts an experiment after adding results that are already known.
///
/// # Errors
/// As [`run_experiment`].
pub fn run_experiment_with_known_results(
    command: &str,
    experiment: &Experiment,
    options: &PlayOptions,
    context: &Context,
    add_known: impl FnOnce(&mut PreparedExperiment<'_>),
) -> Result<ExperimentResults, Failure> {
    let path = context.laboratory_folder()?.join(format!("{command}.jsonl"));
    let all: Vec<usize> = (0..experiment.arms.len() * experiment.seeds.len()).collect();
    let every = |prepared: PreparedExperiment<'_>, with: &ExperimentContext<'_>| prepared.run(with);
    run_with_result_file(&path, experiment, &all, (options, context), add_known, every)
}

/// Conducts only the experiment's runs with the given numbers, and stores their results in a file.
///
/// # Errors
/// As [`run_experiment`].
pub fn run_experiment_part(
    path: &Path,
    experiment: &Experiment,
    numbers: &[usize],
    options: &PlayOptions,
    context: &Context,
) -> Result<Vec<RunResult>, Failure> {
    let some =
        |prepared: PreparedExperiment<'_>, with: &ExperimentContext<'_>| prepared.run_numbered(numbers, with);
    run_with_result_file(path, experiment, numbers, (options, context), |_| (), some)
}

fn run_with_result_file<R>(
    path: &Path,
    experiment: &Experiment,
    numbers: &[usize],
    (options, context): (&PlayOptions, &Context),
    add_known: impl FnOnce(&mut PreparedExperiment<'_>),
    conduct: impl FnOnce(PreparedExperiment<'_>, &ExperimentContext<'_>) -> Result<R, ExperimentError>,
) -> Result<R, Failure> {
    let pool = thread_pool(options.jobs)?;
    let store = ResultStore::open(path)
        .map_err(|error| Failure::from(ExperimentError::Store { path: path.to_owned(), error }))?;
    let mut prepared = experiment.prepare(&context.configuration, Some(&store), options.fresh)?;
    add_known(&mut prepared);
    let left = prepared.remaining_runs(numbers);
    let progress = progress_bar(left as u64, "runs");
    let stop = stop_flag_on_signals();
    let on_run = || progress.inc(1);
    let with = ExperimentContext {
        configuration: &context.configuration,
        store: Some(&store),
        pool: &pool,
        stop: &stop,
        on_run: &on_run,
    };
    let results = conduct(prepared, &with);
    progress.finish_and_clear();
    Ok(results?)
}

/// Returns a flag that is set by ctrl-c. A second ctrl-c ends the program immediately.
pub fn stop_flag_on_signals() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    #[cfg(unix)]
    for (signal, code) in [(signal_hook::consts::SIGINT, 130), (signal_hook::consts::SIGTERM, 143)] {
        // Without a handler, the signal ends the program. Cached results are kept.
        let _ = signal_hook::flag::register_conditional_shutdown(signal, code, Arc::clone(&stop));
        let _ = signal_hook::flag::register(signal, Arc::clone(&stop));
    }
    stop
}
