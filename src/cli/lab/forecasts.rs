//! `novamind lab forecasts`: measures the errors of the outlook and the coverage of its ranges.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use rayon::prelude::*;

use super::super::output_file::write_text;
use super::super::run::{SeedRange, parse_seeds, progress_bar, thread_pool};
use super::super::{Context, Failure, print};
use crate::lab::{
    CompanyForecasts, Policy, StageResult, backtest_policy, backtest_recorded_run, forecast_horizons,
    measure_intervals, random_policy, stage_results,
};
use crate::session::{ErrorIntervals, GrowthStage};

/// Scenarios of the measurement: the rules of both releases of the simulator.
const SCENARIOS: [&str; 2] = ["default", "release-2"];

#[derive(Debug, Args)]
pub struct Options {
    /// Seeds to play with each policy
    #[arg(long, default_value = "1..10", value_name = "A..B", value_parser = parse_seeds)]
    seeds: SeedRange,
    /// Play only this policy, by name or path; can be repeated [default: all bundled policies and random settings]
    #[arg(long, value_name = "NAME|FILE")]
    only: Vec<String>,
    /// Number of companies with randomly drawn settings per scenario
    #[arg(long, default_value_t = 120, value_name = "N", conflicts_with = "only")]
    random: u64,
    /// Also replay the recorded runs in this folder
    #[arg(long, value_name = "FOLDER")]
    recorded: Option<PathBuf>,
    /// Scenario; can be repeated [default: default and release-2]
    #[arg(long, value_name = "NAME")]
    scenario: Vec<String>,
    /// Number of companies to play in parallel
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Measure new ranges and write them to this file, instead of testing the bundled ranges
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
}

/// A company to play: its policy, seed and scenario.
type Game<'a> = (Policy, u64, &'a str);

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let mut companies = play_companies(options, context)?;
    if let Some(folder) = &options.recorded {
        companies.extend(replay_recorded_runs(folder)?);
    }
    let mut results = stage_results(&companies);
    if let Some(path) = &options.write {
        let intervals = measure_intervals(&companies);
        set_measured_coverage(&mut results, &intervals);
        let text = toml::to_string(&intervals).map_err(|error| Failure::failed(error.to_string()))?;
        let head = "# Ranges of cash around the expected cash, by stage of growth and horizon, as shares of the error scale \
                    (src/session/figures/outlook).\n# `novamind lab forecasts --write` writes this file. The coverage of each half \
                    of the companies was measured with the ranges of the other half.\n\n";
        write_text(path, &format!("{head}{text}"))?;
    }
    print(&format!("{} companies\n{}", companies.len(), coverage_table(&results)))
}

/// Plays all policies and random settings on all seeds and scenarios. Returns the companies in the order in
/// which they are listed.
fn play_companies(options: &Options, context: &Context) -> Result<Vec<CompanyForecasts>, Failure> {
    let scenarios: Vec<&str> = match options.scenario.is_empty() {
        true => SCENARIOS.to_vec(),
        false => options.scenario.iter().map(String::as_str).collect(),
    };
    let names: Vec<String> = match options.only.is_empty() {
        true => novamind_assets::policies().into_iter().map(|(name, _)| name.to_owned()).collect(),
        false => options.only.clone(),
    };
    let policies: Result<Vec<Policy>, _> =
        names.iter().map(|name| Policy::find(name, &context.configuration)).collect();
    let policies = policies?;
    let random = if options.only.is_empty() { options.random } else { 0 };
    let mut games: Vec<Game<'_>> = Vec::new();
    for (at, scenario) in scenarios.iter().enumerate() {
        for policy in &policies {
            games.extend(
                (options.seeds.first..=options.seeds.last).map(|seed| (policy.clone(), seed, *scenario)),
            );
        }
        let first = random * at as u64;
        games.extend((first..first + random).map(|seed| (random_policy(seed), seed, *scenario)));
    }
    let bar = progress_bar(games.len() as u64, "runs");
    let played: Result<Vec<CompanyForecasts>, _> = thread_pool(options.jobs)?.install(|| {
        let play = |(policy, seed, scenario): &Game<'_>| {
            let company = backtest_policy(policy, *seed, Some(scenario), &context.configuration);
            bar.inc(1);
            company
        };
        games.par_iter().map(play).collect()
    });
    bar.finish_and_clear();
    Ok(played?)
}

/// Replays all runs in a folder, in the order of their names.
fn replay_recorded_runs(folder: &Path) -> Result<Vec<CompanyForecasts>, Failure> {
    let failed = |error: std::io::Error| Failure::failed(format!("{}: {error}", folder.display()));
    let mut runs: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.join("trajectory.jsonl").is_file() {
            runs.push(path);
        }
    }
    runs.sort();
    let replayed: Result<Vec<CompanyForecasts>, _> =
        runs.iter().map(|run| backtest_recorded_run(run)).collect();
    Ok(replayed?)
}

/// Replaces the coverage in the results with the coverage of newly measured intervals, which was measured on
/// companies that did not contribute to the intervals.
fn set_measured_coverage(
    results: &mut BTreeMap<(GrowthStage, u32), StageResult>,
    intervals: &ErrorIntervals,
) {
    for ((stage, horizon), result) in results {
        if let Some(interval) = intervals.stage_interval(*stage, *horizon) {
            (result.covered_80, result.covered_95) = (interval.covered_80, interval.covered_95);
        }
    }
}

/// Returns a table by stage and horizon.
fn coverage_table(results: &BTreeMap<(GrowthStage, u32), StageResult>) -> String {
    let mut text = format!(
        "{:<10}{:>9}{:>11}{:>11}{:>13}{:>14}{:>11}{:>11}\n",
        "stage", "horizon", "companies", "forecasts", "mean error", "median error", "in 80 %", "in 95 %"
    );
    let percent = |share: f64| format!("{:.1} %", share * 100.0);
    for (stage, horizon) in GrowthStage::ALL
        .into_iter()
        .flat_map(|stage| forecast_horizons().into_iter().map(move |days| (stage, days)))
    {
        let Some(result) = results.get(&(stage, horizon)) else { continue };
        text += &format!(
            "{:<10}{:>9}{:>11}{:>11}{:>13}{:>14}{:>11}{:>11}\n",
            stage.id(),
            format!("{horizon} days"),
            result.companies,
            result.forecasts,
            percent(result.mean_error),
            percent(result.median_error),
            percent(result.covered_80),
            percent(result.covered_95)
        );
    }
    text
}
