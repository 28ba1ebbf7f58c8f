//! `novamind lab bound`: the paper's account of an upper bound.

use clap::Args;

use super::output::OutputOptions;
use super::world::WorldOptions;
use crate::cli::{Context, Failure};
use crate::lab::bound::{BoundAccount, Premises, bound_exhibit, sensitivity};

/// Options of `lab bound`.
#[derive(Debug, Args)]
pub struct Options {
    /// So many times over is targeted development paid that is just enough.
    #[arg(long, default_value = "3", value_name = "1..4", value_parser = parse_slack)]
    slack: u8,
    #[command(flatten)]
    world: WorldOptions,
    #[command(flatten)]
    output: OutputOptions,
}

/// Reads a slack.
fn parse_slack(text: &str) -> Result<u8, String> {
    let whole = text.parse::<u8>().ok().filter(|slack| (1..=4).contains(slack));
    whole.ok_or_else(|| format!("{text} is no slack: 1, 2, 3 or 4"))
}

/// Runs the command; nothing is played.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let (days, params) = options.world.terms(context)?;
    let premises = Premises::of_the_paper(f64::from(options.slack));
    if days != premises.run_days {
        return Err(Failure::usage(format!(
            "the account prices runs of {} days and compares them with the published ones; these parameters are of {days} days",
            premises.run_days
        )));
    }
    let account = BoundAccount::of(premises, &params);
    let slacks = sensitivity(&[1.0, 2.0, 3.0, 4.0], &params);
    options.output.show(&bound_exhibit(&account, &slacks))
}
