//! `novamind lab`: experiments with policies, and comparisons of runs with each other and with published figures.

mod ablate;
mod baseline;
mod behaviour;
mod bound;
mod comparison;
mod consistency;
mod curves;
mod difference;
mod distributions;
mod experiments;
mod forecasts;
mod metrics;
mod opponents;
mod output;
mod results;
mod runs;
mod study;
mod world;

#[cfg(feature = "server")]
pub use experiments::stop_flag_on_signals;
#[cfg(feature = "server")]
pub use output::OutputOptions;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use rayon::prelude::*;

use super::run::{SeedRange, parse_seeds, progress_bar, thread_pool};
use super::{Context, Failure, print};
use crate::lab::{
    GoldenComparison, MetricValue, MetricsCollector, Policy, ReferenceFigures, RunSpec,
    compare_with_reference, play_policy, read_reference, read_reference_scenario,
};

#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    command: LabCommand,
}

#[derive(Debug, Subcommand)]
enum LabCommand {
    /// Play the paper's 24 rule-based configurations, or another grid, over many seeds
    Baseline(baseline::Options),
    /// Play a policy against competitors that copy more and more, and show the cost of each step
    Ablate(ablate::Options),
    /// Compute the paper's upper bound from the parameters, line by line next to the published figures
    Bound(bound::Options),
    /// Show every distribution that the simulator draws from: parameters, sample draws, moments
    #[command(name = "distributions", alias = "laws")]
    Laws(distributions::Options),
    /// Draw participation curves: the quality that customers require at a price
    Curves(curves::Options),
    /// Run the policies of a reference folder over many seeds and compare the results with the reference figures
    Golden(GoldenOptions),
    /// Play policies and measure the coverage of naive forecasts
    Forecasts(forecasts::Options),
    /// Compare runs: cash by week, decisions, behavior measures, and the paper's published figures
    Compare(comparison::Options),
    /// Compare your runs with the published results: bankruptcies, best run, days survived, calls per week
    Table(results::Options),
    /// Show how runs were played: ads, forecasts, tools, notes, customers, cash
    #[command(name = "behavior", alias = "behaviour")]
    Behaviour(behaviour::Options),
    /// Play two policies on the same seed and check that both policies use the same random draws
    Consistency(consistency::Options),
    /// Print all figures of a run day by day, including hidden figures; for debug runs and finished runs
    Metrics(metrics::Options),
    /// Play the strong policies and the baseline with the seed and parameters of a finished run
    Opponents(opponents::Options),
    /// Play all combinations of policies, scenarios, parameters and seeds, and write one tidy table, whole or in shards
    Study(study::Options),
    /// Merge the shards of a study
    Merge(study::MergeOptions),
    /// Show the differences between two runs on a day: state, figures and customers
    Diff(difference::Options),
}

#[derive(Debug, Args)]
struct GoldenOptions {
    /// Folder with one <policy>.csv per policy
    folder: PathBuf,
    /// Folder of policy files [default: the reference folder, otherwise the bundled policies]
    #[arg(long, value_name = "DIR")]
    policies: Option<PathBuf>,
    /// Scenario [default: the scenario in reference.toml of the folder, otherwise the scenario of the policies]
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Seeds, at least 24; suspicious figures are checked again on the same number of subsequent seeds
    #[arg(long, default_value = "1..24", value_name = "A..B", value_parser = parse_seeds)]
    seeds: SeedRange,
    /// Compare only this policy; can be repeated
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Figures to leave out; a name ending in * matches every name with that prefix
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    without: Vec<String>,
    /// Number of seeds to play in parallel
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Print every compared cell instead of the ten worst
    #[arg(long)]
    all: bool,
}

/// Lowest accepted share of cells with |z| < 3 for one policy.
const MIN_POLICY_SHARE: f64 = 0.95;
/// Lowest accepted share of cells with |z| < 3 for all policies together.
const MIN_TOTAL_SHARE: f64 = 0.97;

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    match &options.command {
        LabCommand::Baseline(options) => baseline::run(options, context),
        LabCommand::Ablate(options) => ablate::run(options, context),
        LabCommand::Bound(options) => bound::run(options, context),
        LabCommand::Laws(options) => distributions::run(options, context),
        LabCommand::Curves(options) => curves::run(options, context),
        LabCommand::Golden(golden) => run_golden(golden, context),
        LabCommand::Forecasts(options) => forecasts::run(options, context),
        LabCommand::Compare(options) => comparison::run(options, context),
        LabCommand::Table(options) => results::run(options, context),
        LabCommand::Behaviour(options) => behaviour::run(options, context),
        LabCommand::Consistency(options) => consistency::run(options, context),
        LabCommand::Metrics(options) => metrics::run(options, context),
        LabCommand::Opponents(options) => opponents::run(options, context),
        LabCommand::Study(options) => study::run(options, context),
        LabCommand::Merge(options) => study::merge_shards(options),
        LabCommand::Diff(options) => difference::run(options, context),
    }
}

struct Verdict {
    comparison: GoldenComparison,
    biased: Vec<(String, f64, f64)>,
}

impl Verdict {
    fn passes(&self) -> bool {
        self.comparison.share_below(3.0) >= MIN_POLICY_SHARE
            && self.biased.is_empty()
            && self.comparison.missing.is_empty()
    }
}

fn run_golden(golden: &GoldenOptions, context: &Context) -> Result<(), Failure> {
    let names = policy_names(&golden.folder, &golden.only)?;
    let pool = thread_pool(golden.jobs)?;
    let scenario = golden_scenario(golden, context)?;
    let scenario = scenario.as_deref();
    let (mut verdicts, mut unplayed) = (Vec::new(), Vec::new());
    for name in &names {
        let mut reference = read_reference(&golden.folder, name)?;
        reference.cells.retain(|(figure, group, _), _| !is_excluded(&golden.without, figure, group));
        // If a policy cannot be played, report the failure and continue with the next policy.
        let policy = match find_policy(golden, context, name) {
            Ok(policy) => policy,
            Err(failure) => {
                print(&format!("{name}  cannot be played: {failure}\n"))?;
                unplayed.push(name.as_str());
                continue;
            }
        };
        let seeds = &golden.seeds;
        let comparison = compare_with_reference(
            &reference,
            &checkpoint_figures(&policy, scenario, &reference, seeds, context, &pool)?,
        );
        let biased = confirm_bias(&comparison, &policy, scenario, &reference, seeds, context, &pool)?;
        let verdict = Verdict { comparison, biased };
        print(&describe_verdict(&verdict, golden.all))?;
        verdicts.push(verdict);
    }
    print_summary(&verdicts, &unplayed, &golden.seeds)
}

/// Returns the scenario of the comparison. Prints the scenario if the option or the reference determines it.
fn golden_scenario(golden: &GoldenOptions, context: &Context) -> Result<Option<String>, Failure> {
    let scenario = match &golden.scenario {
        Some(name) => Some(name.clone()),
        None => read_reference_scenario(&golden.folder)?,
    };
    if let Some(name) = &scenario {
        context.configuration.load_scenario(name)?;
        print(&format!("scenario {name}\n"))?;
    }
    Ok(scenario)
}

fn is_excluded(without: &[String], figure: &str, group: &str) -> bool {
    let full = if group.is_empty() { figure.to_owned() } else { format!("{figure}:{group}") };
    without.iter().any(|pattern| match pattern.strip_suffix('*') {
        Some(start) => full.starts_with(start),
        None => *pattern == figure || *pattern == full,
    })
}

fn policy_names(folder: &Path, only: &[String]) -> Result<Vec<String>, Failure> {
    let entries = std::fs::read_dir(folder)
        .map_err(|error| Failure::unreadable(format!("{}: {error}", folder.display())))?;
    let mut names: Vec<String> = entries
        .flatten()
        .filter_map(|entry| Some(entry.file_name().to_str()?.strip_suffix(".csv")?.to_owned()))
        .filter(|name| only.is_empty() || only.contains(name))
        .collect();
    names.sort_unstable();
    if names.is_empty() {
        return Err(Failure::usage(format!("{} has no figures of these policies", folder.display())));
    }
    Ok(names)
}

fn find_policy(golden: &GoldenOptions, context: &Context, name: &str) -> Result<Policy, Failure> {
    for folder in [golden.policies.as_ref(), Some(&golden.folder)].into_iter().flatten() {
        let file = folder.join(format!("{name}.toml"));
        if file.exists() {
            return Ok(Policy::find(&file.to_string_lossy(), &context.configuration)?);
        }
    }
    Ok(Policy::find(name, &context.configuration)?)
}

/// Returns the figures of every seed at the checkpoint days of a reference.
fn checkpoint_figures(
    policy: &Policy,
    scenario: Option<&str>,
    reference: &ReferenceFigures,
    seeds: &SeedRange,
    context: &Context,
    pool: &rayon::ThreadPool,
) -> Result<Vec<Vec<MetricValue>>, Failure> {
    let progress = progress_bar(seeds.last - seeds.first + 1, "runs");
    let until = reference.last_day();
    let one = |seed: u64| {
        let spec = RunSpec {
            days: policy.start.days.or(Some(500)),
            stop_after_day: Some(until),
            surges: Some(policy.start.surges == Some(true)),
            scenario: scenario.map(str::to_owned),
            ..RunSpec::for_seed(seed)
        };
        let mut collector = MetricsCollector::new(Some(reference.days()));
        let played = play_policy(policy, &spec, &context.configuration, &mut collector);
        progress.inc(1);
        played.map(|_| collector.finish(until)).map_err(Failure::from)
    };
    let range: Vec<u64> = (seeds.first..=seeds.last).collect();
    let all = pool.install(|| range.into_par_iter().with_max_len(1).map(one).collect());
    progress.finish_and_clear();
    all
}

/// Compares suspicious figures again on the subsequent seeds. Returns (figure, first median, second median)
/// for each figure that deviates in the same direction again.
fn confirm_bias(
    comparison: &GoldenComparison,
    policy: &Policy,
    scenario: Option<&str>,
    reference: &ReferenceFigures,
    seeds: &SeedRange,
    context: &Context,
    pool: &rayon::ThreadPool,
) -> Result<Vec<(String, f64, f64)>, Failure> {
    let suspects = comparison.suspect_figures();
    if suspects.is_empty() {
        return Ok(Vec::new());
    }
    let count = seeds.last - seeds.first + 1;
    let following = SeedRange { first: seeds.last + 1, last: seeds.last + count };
    let figures = checkpoint_figures(policy, scenario, reference, &following, context, pool)?;
    let repetition = compare_with_reference(reference, &figures).suspect_figures();
    let confirmed = suspects.into_iter().filter_map(|(figure, first)| {
        let (_, second) = repetition
            .iter()
            .find(|(other, second)| *other == figure && second.signum() == first.signum())?;
        Some((figure, first, *second))
    });
    Ok(confirmed.collect())
}

fn describe_verdict(verdict: &Verdict, all: bool) -> String {
    let comparison = &verdict.comparison;
    let mut text = format!(
        "{}  {} cells  |z| < 2: {:.1} %  |z| < 3: {:.1} %  {}\n",
        comparison.policy,
        comparison.cells.len(),
        100.0 * comparison.share_below(2.0),
        100.0 * comparison.share_below(3.0),
        if verdict.passes() { "passes" } else { "FAILS" },
    );
    for line in comparison.figure_lines() {
        text += &format!("  {line}\n");
    }
    let (head, listed): (_, Vec<_>) = match all {
        true => ("all cells", comparison.cells.iter().collect()),
        false => ("the ten worst cells", comparison.most_different(10)),
    };
    text += &format!("  {head}:\n");
    listed.into_iter().for_each(|cell| text += &format!("    {cell}\n"));
    for cell in &comparison.excluded {
        text += &format!("  excluded from the comparison: {cell}\n");
    }
    for (figure, first) in comparison.suspect_figures() {
        let repetition = verdict.biased.iter().find(|(biased, ..)| *biased == figure);
        text += &match repetition {
            Some((.., second)) => {
                format!("  biased: {figure}, median z {first:.2} and {second:.2} on the subsequent seeds\n")
            }
            None => format!(
                "  suspicious: {figure}, median z {first:.2}, not confirmed on the subsequent seeds\n"
            ),
        };
    }
    for name in &comparison.missing {
        text += &format!("  missing: {name}\n");
    }
    text
}

fn print_summary(verdicts: &[Verdict], unplayed: &[&str], seeds: &SeedRange) -> Result<(), Failure> {
    let cells: usize = verdicts.iter().map(|verdict| verdict.comparison.cells.len()).sum();
    let below = |bound: f64| {
        let counts = verdicts
            .iter()
            .map(|verdict| verdict.comparison.share_below(bound) * verdict.comparison.cells.len() as f64);
        counts.sum::<f64>() / cells.max(1) as f64
    };
    print(&format!(
        "all  {cells} cells  |z| < 2: {:.1} %  |z| < 3: {:.1} %  seeds {}..{}\n",
        100.0 * below(2.0),
        100.0 * below(3.0),
        seeds.first,
        seeds.last
    ))?;
    if seeds.last - seeds.first + 1 < 24 {
        return Err(Failure::usage("a comparison needs at least 24 seeds"));
    }
    let failing = verdicts.iter().filter(|verdict| !verdict.passes());
    let mut problems: Vec<String> =
        failing.map(|verdict| format!("{} differs from the reference", verdict.comparison.policy)).collect();
    problems.extend(unplayed.iter().map(|name| format!("{name} cannot be played")));
    if below(3.0) < MIN_TOTAL_SHARE {
        problems.push(format!(
            "less than {:.0} % of the cells of all policies have |z| < 3",
            100.0 * MIN_TOTAL_SHARE
        ));
    }
    if problems.is_empty() { Ok(()) } else { Err(Failure::failed(problems.join("; "))) }
}
