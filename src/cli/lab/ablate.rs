//! `novamind lab ablate`: the effect of competitors that copy.

use clap::Args;

use super::experiments::{PlayOptions, run_experiment};
use super::output::OutputOptions;
use crate::cli::run::{SeedRange, parse_seeds};
use crate::cli::{Context, Failure};
use crate::lab::Policy;
use crate::lab::ablation::{
    AblationAxis, COPY_SETTINGS, CompetitorSetting, DRAIN_SETTINGS, SHORT_DAYS, ShortRun, ablation_report,
    competitor_arms, rebase_arms, shared_development_probe, short_run_policies, targeted_development_probe,
};
use crate::lab::experiment::{Experiment, ExperimentResults};
use crate::record::folder::configuration::DEFAULT_SCENARIO;

#[derive(Debug, Args)]
pub struct Options {
    /// Policy, by name or path [default: a probe with shared development; to measure draining, a probe with targeted
    /// development]
    #[arg(long, value_name = "NAME|FILE")]
    policy: Option<String>,
    /// Seed, or a range including both ends
    #[arg(long, default_value = "1..24", value_name = "N|A..B", value_parser = parse_seeds)]
    seeds: SeedRange,
    /// Scenario to which the competitor settings are applied
    #[arg(long, default_value = DEFAULT_SCENARIO, value_name = "NAME")]
    scenario: String,
    /// Day on which subscribers are compared, the last day of a week
    #[arg(long, default_value = "140", value_name = "N", value_parser = parse_week_end)]
    day: u32,
    #[command(flatten)]
    play: PlayOptions,
    #[command(flatten)]
    output: OutputOptions,
}

const LONG_DAYS: u32 = 500;

fn parse_week_end(text: &str) -> Result<u32, String> {
    let day: u32 = text.parse().map_err(|_| format!("{text} is not a day"))?;
    match day.is_multiple_of(7) && (7..=LONG_DAYS).contains(&day) {
        true => Ok(day),
        false => Err(format!("give the last day of a week: 7, 14, … {}", LONG_DAYS / 7 * 7)),
    }
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let (shared, targeted) = match &options.policy {
        Some(name) => {
            let policy = Policy::find(name, &context.configuration)?;
            (policy.clone(), policy)
        }
        None => (shared_development_probe()?, targeted_development_probe()?),
    };
    let play =
        |policy: &Policy, settings: &[CompetitorSetting], days: u32| -> Result<ExperimentResults, Failure> {
            let seeds = options.seeds.first..=options.seeds.last;
            let mut arms = competitor_arms(policy, settings, days);
            if options.scenario != DEFAULT_SCENARIO {
                arms = rebase_arms(arms, &options.scenario, &context.configuration)?;
            }
            run_experiment("ablate", &Experiment::new(arms, seeds), &options.play, context)
        };
    let copy = play(&shared, &COPY_SETTINGS, LONG_DAYS)?;
    let drain = play(&targeted, &DRAIN_SETTINGS, LONG_DAYS)?;
    let few: Vec<CompetitorSetting> = COPY_SETTINGS
        .into_iter()
        .filter(|competitor_setting| ["off", "default", "hard"].contains(&competitor_setting.name))
        .collect();
    let mut short = vec![(shared.name.clone(), play(&shared, &few, SHORT_DAYS)?)];
    for (name, policy) in short_run_policies()? {
        short.push((name.to_owned(), play(&policy, &few, SHORT_DAYS)?));
    }
    let scenario = match options.scenario.as_str() {
        DEFAULT_SCENARIO => String::new(),
        name => format!(", scenario: {name}"),
    };
    let axes = [
        AblationAxis {
            name: "copy",
            caption: format!("Copying of the shared bank, policy: {}{scenario}", shared.name),
            policy: &shared.name,
            settings: &COPY_SETTINGS,
            results: &copy,
        },
        AblationAxis {
            name: "drain",
            caption: format!("Draining of the targeted bank, policy: {}{scenario}", targeted.name),
            policy: &targeted.name,
            settings: &DRAIN_SETTINGS,
            results: &drain,
        },
    ];
    let short: Vec<ShortRun<'_>> =
        short.iter().map(|(name, results)| ShortRun { name, settings: &few, results }).collect();
    options.output.show(&ablation_report(&axes, &short, options.day))
}
