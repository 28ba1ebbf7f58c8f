//! `novamind lab behavior`: measures how runs were played.

use clap::Args;

use super::output::OutputOptions;
use super::read_runs::of_runs;
use crate::cli::{Context, Failure};
use crate::lab::behaviour::{ObservedRun, exhibit_of};

#[derive(Debug, Args)]
pub struct Options {
    /// Runs, or `latest` for the newest
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<String>,
    #[command(flatten)]
    output: OutputOptions,
}

/// Runs the command. The runs record only that they were read.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let observed = of_runs(&options.runs, "behaviour", context, |session, trajectory| {
        ObservedRun::of(session, &trajectory.lines)
    })?;
    options.output.show(&exhibit_of(&observed))
}
