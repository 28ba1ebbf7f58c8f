//! `novamind lab forecasts`: measures the coverage of naive forecasts.

use std::path::PathBuf;

use clap::Args;
use rayon::prelude::*;

use super::super::output_file::write_text;
use super::super::run::{SeedRange, parse_seeds, progress_bar, thread_pool};
use super::super::{Context, Failure, print};
use crate::lab::{
    PlayedWeeks, Policy, STRONG_POLICIES, forecast_horizons, interval_coverage, measure_naive_intervals,
    play_weeks, policy_names,
};
use crate::session::ErrorIntervals;

#[derive(Debug, Args)]
pub struct Options {
    /// Seeds to play with each policy
    #[arg(long, default_value = "1..24", value_name = "A..B", value_parser = parse_seeds)]
    seeds: SeedRange,
    /// Play only this policy, by name or path; can be repeated [default: the bundled policies except the strong policies]
    #[arg(long, value_name = "NAME|FILE")]
    only: Vec<String>,
    /// Scenario [default: the scenario of the policies]
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Number of seeds to play in parallel
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Measure new intervals and write them to this file, instead of testing the bundled intervals
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let runs = play_runs(options, context)?;
    let horizons = forecast_horizons();
    let seeds = options.seeds.last + 1 - options.seeds.first;
    let measured = options.write.as_ref().map(|_| measure_naive_intervals(&runs, &horizons, seeds));
    let bands = measured.as_ref().unwrap_or(ErrorIntervals::bundled());
    print(&coverage_table(&runs, &horizons, bands))?;
    if let (Some(path), Some(bands)) = (&options.write, &measured) {
        let text = toml::to_string(bands).map_err(|error| Failure::failed(error.to_string()))?;
        let head = "# Intervals of naive forecasts, as shares of the income and costs expected until the horizon. `novamind lab \
                    forecasts --write`\n# writes this file.\n\n";
        write_text(path, &format!("{head}{text}"))?;
    }
    Ok(())
}

/// Plays each policy on each seed. Returns the runs in the order of policies and seeds.
fn play_runs(options: &Options, context: &Context) -> Result<Vec<PlayedWeeks>, Failure> {
    let names: Vec<String> = match options.only.is_empty() {
        true => {
            let names = novamind_assets::policies().into_iter().map(|(name, _)| name);
            names.filter(|name| !STRONG_POLICIES.contains(name)).map(str::to_owned).collect()
        }
        false => options.only.clone(),
    };
    let policies: Result<Vec<Policy>, _> =
        names.iter().map(|name| Policy::find(name, &context.configuration)).collect();
    let policies = policies?;
    let seeds = options.seeds.first..=options.seeds.last;
    let games: Vec<(&Policy, u64)> =
        policies.iter().flat_map(|policy| seeds.clone().map(move |seed| (policy, seed))).collect();
    let bar = progress_bar(games.len() as u64, "runs");
    let pool = thread_pool(options.jobs)?;
    let runs: Result<Vec<PlayedWeeks>, _> = pool.install(|| {
        let play = |(policy, seed): &(&Policy, u64)| {
            let run = play_weeks(policy, *seed, options.scenario.as_deref(), &context.configuration);
            bar.inc(1);
            run
        };
        games.par_iter().map(play).collect()
    });
    bar.finish_and_clear();
    Ok(runs?)
}

/// Returns a table of the coverage by policy and horizon.
fn coverage_table(runs: &[PlayedWeeks], horizons: &[u32], bands: &ErrorIntervals) -> String {
    let row = |name: &str, policy: Option<&str>| {
        let cells = horizons.iter().map(|horizon| {
            let coverage = interval_coverage(runs, policy, *horizon, bands);
            match coverage.forecasts {
                0 => format!("{:>18}", "–"),
                count => format!("{:>7.1} % of {:>5}", coverage.held * 100.0, count),
            }
        });
        format!("{name:<12}{}\n", cells.collect::<String>())
    };
    let mut text = format!("{:<12}", "policy");
    horizons.iter().for_each(|days| text += &format!("{:>18}", format!("{days} days")));
    text.push('\n');
    policy_names(runs).into_iter().for_each(|policy| text += &row(policy, Some(policy)));
    text + &row("all", None)
}
