//! `novamind run`: plays a policy on one or many seeds.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};

use clap::{Args, ValueEnum};
use rayon::prelude::*;

use super::output_file::check_signature;
use super::{Context, Failure, print};
use crate::lab::{
    MetricValue, MetricsCollector, Policy, PolicyRunOutcome, RunEnd, RunError, RunSpec, play_policy,
};
pub use crate::lab::{SeedRange, parse_seeds};

#[derive(Debug, Args)]
pub struct Options {
    /// Name of a policy, or path of a policy file
    #[arg(long, value_name = "NAME|FILE")]
    policy: String,
    /// Seed, or a range including both ends: 1..24
    #[arg(long, default_value = "42", value_name = "N|A..B", value_parser = parse_seeds)]
    seed: SeedRange,
    /// Last day of the run; affects the mechanics [default: the policy's or scenario's last day, otherwise 500]
    #[arg(long, value_name = "N")]
    days: Option<u32>,
    /// Stop after this day; the last day of the run does not change
    #[arg(long, value_name = "N")]
    until: Option<u32>,
    /// Demand surges [default: as in the policy or scenario]
    #[arg(long, value_enum)]
    surges: Option<Switch>,
    /// Starting cash in dollars
    #[arg(long, value_name = "X")]
    cash: Option<f64>,
    /// Name of the scenario
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Set a parameter; can be repeated
    #[arg(long, value_name = "TABLE.KEY=VALUE", value_parser = parse_override)]
    set: Vec<(String, String)>,
    /// Number of seeds to play in parallel [default: the number of processors]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Write the figures of every day to this file as CSV
    #[arg(long, value_name = "FILE.csv")]
    metrics: Option<PathBuf>,
    /// Days whose figures are written [default: all days]
    #[arg(long, value_name = "N,N,…", value_delimiter = ',', requires = "metrics")]
    metrics_days: Option<Vec<u32>>,
    /// Save the runs with their databases
    #[arg(long)]
    save: bool,
    /// Exit with code 4 if a run ends in bankruptcy
    #[arg(long)]
    fail_on_bankruptcy: bool,
    /// Print one JSON object per seed
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// Demand surges on
    On,
    /// Demand surges off
    Off,
}

/// Parses `table.key=value`.
pub fn parse_override(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), value.trim().to_owned())),
        _ => Err("write a parameter as table.key=value".to_owned()),
    }
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let policy = Policy::find(&options.policy, &context.configuration)?;
    let save = if options.save { Some(context.runs_folder()?) } else { None };
    let spec = RunSpec {
        seed: 0,
        days: options.days,
        stop_after_day: options.until,
        surges: options.surges.map(|switch| switch == Switch::On),
        cash: options.cash,
        scenario: options.scenario.clone(),
        overrides: options.set.clone(),
        saves_database: save.is_some(),
        save_folder: save,
    };
    let mut book = ResultWriter {
        metrics: options.metrics.as_ref().map(open_metrics).transpose()?,
        options,
        bankrupt: false,
    };
    let seeds: Vec<u64> = (options.seed.first..=options.seed.last).collect();
    let progress = progress_bar(seeds.len() as u64, "runs");
    let results = play_seeds(&policy, &spec, seeds, options, context)?;
    let results = results.into_iter().inspect(|_| progress.inc(1));
    let write = |(_, outcome, collector): PlayedSeed| progress.suspend(|| book.write(&outcome?, collector));
    let failure = write_in_order(results, options.seed.first..=options.seed.last, write).err();
    progress.finish_and_clear();
    if let Some(mut file) = book.metrics {
        file.flush().map_err(|error| Failure::failed(format!("cannot write the figures: {error}")))?;
    }
    match failure {
        Some(failure) => Err(failure),
        None if book.bankrupt && options.fail_on_bankruptcy => Err(Failure::bankrupt()),
        None => Ok(()),
    }
}

/// Seed, outcome and collected figures of a run.
type PlayedSeed = (u64, Result<PolicyRunOutcome, RunError>, MetricsCollector);

/// Plays all seeds on a thread pool. Results arrive in any order.
fn play_seeds(
    policy: &Policy,
    spec: &RunSpec,
    seeds: Vec<u64>,
    options: &Options,
    context: &Context,
) -> Result<Receiver<PlayedSeed>, Failure> {
    let pool = thread_pool(options.jobs)?;
    let (done, results) = channel();
    let (policy, spec, configuration) = (policy.clone(), spec.clone(), context.configuration.clone());
    let (wanted, days) = (options.metrics.is_some(), options.metrics_days.clone());
    std::thread::spawn(move || {
        pool.install(|| {
            seeds.into_par_iter().with_max_len(1).for_each_with(done, |done, seed| {
                let run_spec = RunSpec { seed, ..spec.clone() };
                let mut collector =
                    if wanted { MetricsCollector::new(days.clone()) } else { MetricsCollector::disabled() };
                let outcome = play_policy(&policy, &run_spec, &configuration, &mut collector);
                // Sending fails only if the receiver was dropped because another seed failed.
                let _ = done.send((seed, outcome, collector));
            });
        });
    });
    Ok(results)
}

/// Writes the results in seed order. Each result is written as soon as all results of lower seeds are written.
///
/// # Errors
/// A result cannot be written, or a thread panicked before its seed had a result.
fn write_in_order(
    results: impl IntoIterator<Item = PlayedSeed>,
    seeds: RangeInclusive<u64>,
    mut write: impl FnMut(PlayedSeed) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut waiting = BTreeMap::new();
    let mut next = *seeds.start();
    for result in results {
        waiting.insert(result.0, result);
        while let Some(result) = waiting.remove(&next) {
            next += 1;
            write(result)?;
        }
    }
    match seeds.contains(&next) {
        true => Err(Failure::failed(format!(
            "internal error: the run of seed {next} did not end; the runs of lower seeds are complete"
        ))),
        false => Ok(()),
    }
}

/// The output files for the results.
struct ResultWriter<'a> {
    metrics: Option<BufWriter<File>>,
    options: &'a Options,
    bankrupt: bool,
}

impl ResultWriter<'_> {
    fn write(&mut self, outcome: &PolicyRunOutcome, collector: MetricsCollector) -> Result<(), Failure> {
        self.bankrupt |= outcome.ended == RunEnd::Bankruptcy;
        if let Some(file) = &mut self.metrics {
            let until = self.options.until.unwrap_or(outcome.days).min(outcome.days);
            write_figures(file, outcome.seed, &collector.finish(until))?;
        }
        print(&format_outcome(outcome, self.options.json))
    }
}

fn format_outcome(outcome: &PolicyRunOutcome, json: bool) -> String {
    if json {
        serde_json::to_string(outcome).expect("an outcome holds plain values") + "\n"
    } else {
        format!("{outcome}\n")
    }
}

const CSV_HEADER: &str = "seed,day,figure,group,value";

fn open_metrics(path: &PathBuf) -> Result<BufWriter<File>, Failure> {
    let failed = |error: std::io::Error| Failure::failed(format!("{}: {error}", path.display()));
    check_signature(path, CSV_HEADER)?;
    let mut file = BufWriter::new(File::create(path).map_err(failed)?);
    writeln!(file, "{CSV_HEADER}").map_err(failed)?;
    Ok(file)
}

/// Formats the figures of a run as rows for `--metrics`.
pub fn figure_rows(seed: &str, figures: &[MetricValue]) -> String {
    let row = |metric_value: &MetricValue| {
        format!(
            "{seed},{},{},{},{}\n",
            metric_value.day, metric_value.figure, metric_value.group, metric_value.value
        )
    };
    format!("{CSV_HEADER}\n{}", figures.iter().map(row).collect::<String>())
}

fn write_figures(file: &mut BufWriter<File>, seed: u64, figures: &[MetricValue]) -> Result<(), Failure> {
    for MetricValue { day, figure, group, value } in figures {
        writeln!(file, "{seed},{day},{figure},{group},{value}")
            .map_err(|error| Failure::failed(format!("cannot write the figures: {error}")))?;
    }
    Ok(())
}

/// Upper limit of `--jobs`, higher than the number of processors in any supported machine.
const MAX_JOBS: usize = 1024;

/// Creates a pool of worker threads.
pub fn thread_pool(jobs: Option<usize>) -> Result<rayon::ThreadPool, Failure> {
    if jobs.is_some_and(|jobs| !(1..=MAX_JOBS).contains(&jobs)) {
        return Err(Failure::usage(format!(
            "--jobs must be 1 to {MAX_JOBS}; the default is the number of processors"
        )));
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(jobs.unwrap_or(0))
        .build()
        .map_err(|error| Failure::failed(format!("cannot start threads: {error}")))
}

/// Returns a progress bar that appears on standard error after half a second. The progress bar is hidden if standard
/// error is not a terminal.
pub fn progress_bar(length: u64, what: &'static str) -> indicatif::ProgressBar {
    use std::io::IsTerminal;
    if length < 2 || !std::io::stderr().is_terminal() {
        return indicatif::ProgressBar::hidden();
    }
    let style = "{bar:40} {pos} of {len} {msg}  {elapsed}, about {eta} left";
    let style = indicatif::ProgressStyle::with_template(style)
        .unwrap_or_else(|_| indicatif::ProgressStyle::default_bar());
    indicatif::ProgressBar::new(length).with_style(style).with_message(what)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::Rejection;

    #[test]
    fn write_in_order_fails_if_a_seed_has_no_result() {
        let played = |seed| {
            let rejection = Rejection::new("no_play", "nothing was played");
            let error =
                RunError::Refused { seed, day: 0, tool: "test".to_owned(), rejection: Box::new(rejection) };
            (seed, Err(error), MetricsCollector::disabled())
        };
        let written = |seeds: &[u64]| {
            let mut written = Vec::new();
            let done = write_in_order(seeds.iter().copied().map(played), 3..=5, |result| {
                written.push(result.0);
                Ok(())
            });
            (written, done.map_err(|failure| failure.to_string()))
        };
        assert_eq!(written(&[5, 3, 4]), (vec![3, 4, 5], Ok(())));
        let (lower, failure) = written(&[5, 3]);
        assert_eq!(lower, [3]);
        assert!(failure.is_err_and(|text| text.contains("the run of seed 4 did not end")));
    }

    #[test]
    fn parse_override_splits_key_and_value() {
        assert_eq!(parse_override("a.b = 3"), Ok(("a.b".to_owned(), "3".to_owned())));
        assert!(parse_override("a.b").is_err());
    }
}
