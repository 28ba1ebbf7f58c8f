//! `novamind bench`: the speed of this machine's simulator.

use clap::Args;

use super::{Context, Failure, print};

/// Options of `bench`.
#[derive(Debug, Args)]
pub struct Options {
    /// As JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(options: &Options, _: &Context) -> Result<(), Failure> {
    let _ = options.json;
    print("later\n")
}
