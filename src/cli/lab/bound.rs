//! `novamind lab bound`: computes the paper's upper bound.

use clap::Args;

use super::output::OutputOptions;
use super::world::WorldOptions;
use crate::cli::{Context, Failure};
use crate::lab::bound::{BoundAccount, BoundAssumptions, bound_report, sensitivity};

#[derive(Debug, Args)]
pub struct Options {
    /// Spending on targeted development, as a multiple of the minimum: 1 to 4
    #[arg(long, default_value = "3", value_name = "1..4", value_parser = parse_slack)]
    slack: u8,
    #[command(flatten)]
    world: WorldOptions,
    #[command(flatten)]
    output: OutputOptions,
}

fn parse_slack(text: &str) -> Result<u8, String> {
    let whole = text.parse::<u8>().ok().filter(|slack| (1..=4).contains(slack));
    whole.ok_or_else(|| format!("{text} is not a valid slack; use 1, 2, 3 or 4"))
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let (days, params) = options.world.days_and_params(context)?;
    let premises = BoundAssumptions::from_paper(f64::from(options.slack));
    if days != premises.run_days {
        return Err(Failure::usage(format!(
            "the bound is defined for runs of {} days, as published; these parameters have {days} days",
            premises.run_days
        )));
    }
    let account = BoundAccount::new(premises, &params);
    let slacks = sensitivity(&[1.0, 2.0, 3.0, 4.0], &params);
    options.output.show(&bound_report(&account, &slacks))
}
