//! `novamind replay`: simulate a run again and compare.

use std::path::PathBuf;

use clap::Args;

use super::{Context, Failure, print};
use crate::session::{find_run_to_read, verify};

/// Options of `replay`.
#[derive(Debug, Args)]
pub struct Options {
    /// Run, `latest` (the newest), or a run's folder or trajectory.
    run: String,
    /// Simulate again and compare every recorded state.
    #[arg(long)]
    verify: bool,
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    if !options.verify {
        return Err(Failure::usage("say --verify: the run is simulated again and every state compared"));
    }
    let path = PathBuf::from(&options.run);
    let folder = if path.is_dir() {
        path
    } else if path.is_file() {
        path.parent().map(PathBuf::from).unwrap_or_default()
    } else {
        find_run_to_read(&context.runs()?, &options.run)?
    };
    let found = verify(&folder)?;
    print(&format!(
        "run {}: {} lines, {} states reached again, day {}, state {}\n",
        found.run, found.lines, found.states, found.day, found.state_hash
    ))
}
