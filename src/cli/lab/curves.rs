//! `novamind lab curves`: participation curves.

use clap::Args;

use super::output::OutputOptions;
use crate::cli::run::parse_override;
use crate::cli::{Context, Failure};
use crate::lab::curves::{all_curves, curve_of};
use crate::session::DEFAULT_SCENARIO;
use crate::world::identifiers::Group;

/// Options of `lab curves`.
#[derive(Debug, Args)]
pub struct Options {
    /// Only this group, and how its customers differ.
    #[arg(value_name = "GROUP")]
    group: Option<String>,
    /// Scenario whose parameters are in force.
    #[arg(long, default_value = DEFAULT_SCENARIO, value_name = "NAME")]
    scenario: String,
    /// Set a parameter; can be repeated.
    #[arg(long, value_name = "TABLE.KEY=VALUE", value_parser = parse_override)]
    set: Vec<(String, String)>,
    #[command(flatten)]
    output: OutputOptions,
}

/// Runs the command; nothing is played.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let scenario = context.configuration.scenario(&options.scenario)?;
    let params = context.configuration.parameters(&scenario, &options.set, true)?;
    let Some(id) = &options.group else { return options.output.show(&all_curves(&params)) };
    let group = Group::parse(id).ok_or_else(|| {
        let all: Vec<&str> = Group::all().map(Group::id).collect();
        Failure::usage(format!("there is no group {id}; there are {}", all.join(", ")))
    })?;
    options.output.show(&curve_of(group, &params))
}
