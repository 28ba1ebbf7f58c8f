//! `novamind replay`: play a recorded run again, in the console or headless to compare every state.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;

use super::play::show_console;
use super::{Context, Failure, play, print};
use crate::console::effect::Effect;
use crate::console::request::Recorded;
use crate::console::request::Request;
use crate::session::{Goal, Session, find_run_to_read, record_look, verify_sealed};

/// Options of `replay`.
#[derive(Debug, Args)]
pub struct Options {
    /// Run, `latest` (the newest), or a run's folder or trajectory.
    run: String,
    /// Simulate again and compare every recorded state.
    #[arg(long)]
    verify: bool,
    /// Begin after this week.
    #[arg(long, value_name = "N", conflicts_with = "verify")]
    week: Option<u32>,
    /// Begin on the X-ray screen, at the end of the record unless --week says otherwise; of a debug run, or of one that is over.
    #[arg(long, conflicts_with = "verify")]
    xray: bool,
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    if options.verify { check(options, context) } else { show(options, context) }
}

fn show(options: &Options, context: &Context) -> Result<(), Failure> {
    let recorded = recorded(&options.run);
    if options.xray {
        check_inside(&recorded, context)?;
    }
    if !std::io::stdout().is_terminal() || !std::io::stdin().is_terminal() {
        return Err(Failure::usage(
            "a replay needs a terminal; --verify simulates the run again without one and compares every \
             state",
        ));
    }
    let (goal, from) = match (options.week, options.xray) {
        (Some(week), _) => (Goal::Week(week), format!("week {week}")),
        (None, true) => (Goal::Last, "the end".to_owned()),
        (None, false) => (Goal::Week(0), "week 0".to_owned()),
    };
    note_look(&recorded, &from, context)?;
    let effect = match options.xray {
        true => Effect::ReplayInside(recorded, goal),
        false => Effect::Request(Request::Replay { recorded, goal, follow: false }),
    };
    show_console(&play::Options::default(), Some(effect), context)
}

/// Refuses where hidden state of a record stays hidden.
fn check_inside(recorded: &Recorded, context: &Context) -> Result<(), Failure> {
    let folder = match recorded {
        Recorded::Run(id) => Some(find_run_to_read(&context.runs()?, id)?),
        Recorded::File(path) => folder_around(path),
    };
    let folder = folder.ok_or_else(|| {
        Failure::usage(
            "the x-ray looks into runs; this trajectory stands alone, without the folder of its run",
        )
    })?;
    context.check_look(&folder)?;
    Ok(Session::open_to_look_inside(&folder, context.seal_key()?).map(drop)?)
}

/// The folder of a run that a path names: it, or the one in which a trajectory lies.
fn folder_around(path: &Path) -> Option<PathBuf> {
    let is_run = |folder: &&Path| folder.join("run.toml").is_file();
    Some(path).filter(is_run).or_else(|| path.parent().filter(is_run)).map(Path::to_owned)
}

/// Records that a run is read: one of the folder of runs, or in a folder of its own.
fn note_look(recorded: &Recorded, detail: &str, context: &Context) -> Result<(), Failure> {
    let folder = match recorded {
        Recorded::Run(id) => find_run_to_read(&context.runs()?, id)?,
        Recorded::File(path) => match folder_around(path) {
            Some(folder) => folder,
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
