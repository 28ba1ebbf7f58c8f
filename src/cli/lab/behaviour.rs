//! `novamind lab behavior`: measures how runs were played.

use clap::Args;

use super::output::OutputOptions;
use super::runs::map_runs;
use crate::cli::{Context, Failure};
use crate::lab::behavior::{BehaviorRun, behavior_report};

#[derive(Debug, Args)]
pub struct Options {
    /// Ids of runs, or `latest` for the newest run
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<String>,
    #[command(flatten)]
    output: OutputOptions,
}

/// Prints the behavior measures of runs. The only change to a run is a record that the run was read.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let observed = map_runs(&options.runs, "behaviour", context, |session, trajectory| {
        BehaviorRun::from_session(session, &trajectory.lines)
    })?;
    options.output.show(&behavior_report(&observed))
}
