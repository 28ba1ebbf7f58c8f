//! `novamind lab metrics`: prints all figures of a run day by day, including hidden figures.

use clap::Args;

use crate::cli::run::figure_rows;
use crate::cli::{Context, Failure, print};
use crate::insight::{Inspect, open_for_inspection};
use crate::lab::MetricsCollector;
use crate::record::folder::runs::find_run_to_read;

#[derive(Debug, Args)]
pub struct Options {
    /// ID of the run, or `latest` for the newest run; must be a debug run or a finished run
    #[arg(value_name = "RUN")]
    run: String,
}

/// Prints the figures of a run. The only change to the run is a record of the inspection.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let folder = find_run_to_read(&context.runs_folder()?, &options.run)?;
    context.check_view_allowed(&folder)?;
    let mut session = open_for_inspection(&folder, context.seal_key()?)?;
    let mut collector = MetricsCollector::new(None);
    let replayed = session.inspect().replay_days(&mut |day| collector.add_day(day));
    replayed.map_err(|rejection| Failure::failed(rejection.message))?;
    let manifest = session.manifest();
    // Participants of a study must not learn the seed.
    let seed = match manifest.study.is_none() || context.is_experimenter {
        true => manifest.seed.to_string(),
        false => String::new(),
    };
    print(&figure_rows(&seed, &collector.finish(manifest.days)))
}
