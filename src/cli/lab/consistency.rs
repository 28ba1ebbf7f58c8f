//! `novamind lab consistency`: checks that policies on the same seed use the same random draws.

use clap::Args;

use super::output::OutputOptions;
use crate::cli::run::{SeedRange, parse_seeds, progress_bar, thread_pool};
use crate::cli::{Context, Failure};
use crate::lab::Policy;
use crate::lab::consistency::{ConsistencySpec, PLAYS_PER_SEED, check_consistency, contrasting_policies};

#[derive(Debug, Args)]
pub struct Options {
    /// Seed, or a range including both ends: 1..4
    #[arg(long, default_value = "42", value_name = "N|A..B", value_parser = parse_seeds)]
    seeds: SeedRange,
    /// A policy, by name or path; give two [default: two policies that differ in everything that is tested]
    #[arg(long, value_name = "NAME|FILE")]
    policy: Vec<String>,
    /// Scenario [default: the scenario of the policies]
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Stop after this day; the last day of the run does not change
    #[arg(long, value_name = "N")]
    until: Option<u32>,
    /// Number of runs to play in parallel [default: the number of processors]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    #[command(flatten)]
    output: OutputOptions,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let find = |name: &String| Policy::find(name, &context.configuration);
    let policies = match options.policy.as_slice() {
        [] => contrasting_policies()?,
        [one, other] => [find(one)?, find(other)?],
        _ => return Err(Failure::usage("give --policy twice or not at all")),
    };
    let spec = |seeds| ConsistencySpec { seeds, scenario: options.scenario.clone(), until: options.until };
    if let Some(obstacle) = spec(Vec::new()).incomparability_reason(&policies) {
        return Err(Failure::usage(obstacle));
    }
    options.output.reject_graphs()?;
    let seeds: Vec<u64> = (options.seeds.first..=options.seeds.last).collect();
    let progress = progress_bar(seeds.len() as u64 * PLAYS_PER_SEED, "runs");
    let spec = spec(seeds);
    let on_played = || progress.inc(1);
    let check = thread_pool(options.jobs)?
        .install(|| check_consistency(&policies, &spec, &context.configuration, &on_played))?;
    progress.finish_and_clear();
    if check.ends_in_same_state {
        return Err(Failure::usage(
            "the two policies make the same decisions, so nothing is tested: give two different policies",
        ));
    }
    options.output.show(&check.to_lab_report())?;
    match check.failures().count() {
        0 => Ok(()),
        1 => Err(Failure::failed("1 claim about common random draws is false")),
        count => Err(Failure::failed(format!("{count} claims about common random draws are false"))),
    }
}
