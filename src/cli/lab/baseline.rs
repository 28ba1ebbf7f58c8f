//! `novamind lab baseline`: plays the paper's rule-based configurations or another grid.

use clap::Args;

use super::experiments::{PlayOptions, run_experiment, run_experiment_with_known_results};
use super::output::OutputOptions;
use crate::cli::run::{SeedRange, parse_seeds};
use crate::cli::{Context, Failure};
use crate::lab::RunSpec;
use crate::lab::baseline::{
    GridPoint, PAPER_GRID, PolicyGrid, baseline_report, is_shared_run, representative_configurations,
};
use crate::lab::experiment::{Arm, Experiment, ExperimentResults, PreparedExperiment};
use crate::record::folder::configuration::DEFAULT_SCENARIO;
use crate::report::ranking_eligibility::PUBLISHED_DAYS;

#[derive(Debug, Args)]
pub struct Options {
    /// Seed, or a range including both ends
    #[arg(long, default_value = "1..24", value_name = "N|A..B", value_parser = parse_seeds)]
    seeds: SeedRange,
    /// Grid of policies: name of a bundled grid, or path of a file
    #[arg(long, default_value = PAPER_GRID, value_name = "NAME|FILE")]
    grid: String,
    /// Scenario [default: the grid's scenario, otherwise `default`]
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Last day of the runs [default: the grid's or scenario's last day, otherwise 500]
    #[arg(long, value_name = "N")]
    days: Option<u32>,
    #[command(flatten)]
    play: PlayOptions,
    #[command(flatten)]
    output: OutputOptions,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let grid = PolicyGrid::find(&options.grid)?;
    let results = play_grid(&grid, options, context)?;
    let is_paper_experiment = options.grid == PAPER_GRID
        && options.days.is_none_or(|days| days == PUBLISHED_DAYS)
        && options.scenario.as_deref().is_none_or(|name| name == DEFAULT_SCENARIO);
    options.output.show(&baseline_report(&grid, is_paper_experiment, &results))
}

/// Plays the representatives first, because the runs of most other configurations equal the run of their
/// representative. A representative has the lowest cash floor among configurations that are otherwise equal.
fn play_grid(grid: &PolicyGrid, options: &Options, context: &Context) -> Result<ExperimentResults, Failure> {
    let points = &grid.configurations;
    let seeds = options.seeds.first..=options.seeds.last;
    let arm = |grid_point: &GridPoint| {
        let mut arm = Arm::new(grid_point.label(), grid_point.policy.clone());
        arm.spec = RunSpec { scenario: options.scenario.clone(), days: options.days, ..arm.spec };
        arm
    };
    let all = Experiment::new(points.iter().map(arm).collect(), seeds.clone());
    let representatives = representative_configurations(points);
    let leading: Vec<usize> = (0..points.len()).filter(|at| representatives[*at] == *at).collect();
    let first = Experiment::new(leading.iter().map(|at| arm(&points[*at])).collect(), seeds);
    let known = run_experiment("baseline", &first, &options.play, context)?;
    let mut starts = Vec::new();
    for point in points {
        starts.push(start_cash(point, options, context)?);
    }
    // The results of the representatives were just computed, so they are used even with `--fresh`.
    let play = PlayOptions { fresh: false, ..options.play.clone() };
    run_experiment_with_known_results(
        "baseline",
        &all,
        &play,
        context,
        |prepared: &mut PreparedExperiment<'_>| {
            for (at, point) in points.iter().enumerate() {
                let representative = &points[representatives[at]];
                let runs = leading.iter().position(|place| *place == representatives[at]);
                for run in runs.into_iter().flat_map(|place| &known.by_arm[place]) {
                    if is_shared_run(&representative.policy, &point.policy, starts[at], run) {
                        prepared.add_result(at, run);
                    }
                }
            }
        },
    )
}

fn start_cash(grid_point: &GridPoint, options: &Options, context: &Context) -> Result<f64, Failure> {
    if let Some(cash) = grid_point.policy.start.cash {
        return Ok(cash);
    }
    let named = options.scenario.as_deref().or(grid_point.policy.start.scenario.as_deref());
    let scenario = context.configuration.load_scenario(named.unwrap_or(DEFAULT_SCENARIO))?;
    Ok(context.configuration.days_and_cash(&scenario, true)?.1)
}
