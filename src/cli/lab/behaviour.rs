//! `novamind lab behaviour`: how runs were played.

use clap::Args;

use super::output::OutputOptions;
use crate::cli::run::progress_bar;
use crate::cli::{Context, Failure};
use crate::lab::behaviour::{ObservedRun, exhibit_of};
use crate::session::{Access, Session, Trajectory, find_run_to_read};

/// Options of `lab behaviour`.
#[derive(Debug, Args)]
pub struct Options {
    /// Runs, or `latest`: the newest.
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<String>,
    #[command(flatten)]
    output: OutputOptions,
}

/// Runs the command; nothing of the runs is changed but that they are read.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let folder = context.runs()?;
    let progress = progress_bar(options.runs.len() as u64, "runs");
    let mut observed = Vec::new();
    for name in &options.runs {
        let own = find_run_to_read(&folder, name)?;
        context.look(&own, "behaviour", &options.runs.join(" "))?;
        let session = Session::open(&own, Access::Read, true)?;
        let trajectory = Trajectory::read(&own.join("trajectory.jsonl"))?;
        observed.push(ObservedRun::of(&session, &trajectory.lines));
        progress.inc(1);
    }
    progress.finish_and_clear();
    options.output.show(&exhibit_of(&observed))
}
