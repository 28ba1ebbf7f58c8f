//! `novamind replay`: play a recorded run again, in the console or headless to compare every state.

use std::io::IsTerminal;
use std::path::PathBuf;

use clap::Args;

use super::play::show_console;
use super::{Context, Failure, play, print};
use crate::console::effect::Effect;
use crate::console::request::Recorded;
use crate::console::request::Request;
use crate::session::{Goal, find_run_to_read, record_look, verify_sealed};

/// Options of `replay`.
#[derive(Debug, Args)]
pub struct Options {
    /// Run, `latest` (the newest), or a run's folder or trajectory.
    run: String,
    /// Simulate again and compare every recorded state.
    #[arg(long)]
    verify: bool,
    /// Begin after this week.
    #[arg(long, value_name = "N", default_value_t = 0, conflicts_with = "verify")]
    week: u32,
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    if options.verify { check(options, context) } else { show(options, context) }
}

fn show(options: &Options, context: &Context) -> Result<(), Failure> {
    if !std::io::stdout().is_terminal() || !std::io::stdin().is_terminal() {
        return Err(Failure::usage(
            "a replay needs a terminal; --verify simulates the run again without one and compares every \
             state",
        ));
    }
    let recorded = recorded(&options.run);
    note_look(&recorded, &format!("week {}", options.week), context)?;
    let effect = Effect::Request(Request::Replay { recorded, goal: Goal::Week(options.week), follow: false });
    show_console(&play::Options::default(), Some(effect), context)
}

/// Records that a run is read: one of the folder of runs, or in a folder of its own.
fn note_look(recorded: &Recorded, detail: &str, context: &Context) -> Result<(), Failure> {
    let folder = match recorded {
        Recorded::Run(id) => find_run_to_read(&context.runs()?, id)?,
        Recorded::File(path) if path.join("run.toml").is_file() => path.clone(),
        // A trajectory that lies where a run is.
        Recorded::File(path) => match path.parent().filter(|folder| folder.join("run.toml").is_file()) {
            Some(folder) => folder.to_owned(),
            None => return Ok(()),
        },
    };
    // Verification shows nothing of the run.
    if detail == "verify" {
        return Ok(record_look(&folder, "replay", detail)?);
    }
    context.look(&folder, "replay", detail)
}

/// A file or folder, if there is one of that name; otherwise a run.
fn recorded(name: &str) -> Recorded {
    let path = PathBuf::from(name);
    if path.exists() { Recorded::File(path) } else { Recorded::Run(name.to_owned()) }
}

fn check(options: &Options, context: &Context) -> Result<(), Failure> {
    let recorded = recorded(&options.run);
    note_look(&recorded, "verify", context)?;
    let place = match recorded {
        Recorded::File(path) => path,
        Recorded::Run(id) => find_run_to_read(&context.runs()?, &id)?,
    };
    let found = verify_sealed(&place, &context.seal_key()?)?;
    print(&format!(
        "run {}: {} lines, {} states reached again, day {}, state {}\n",
        found.run, found.lines, found.states, found.day, found.state_hash
    ))
}
