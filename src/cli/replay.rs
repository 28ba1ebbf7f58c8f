//! `novamind replay`: replays a recorded run in the console, or simulates it again without a terminal to compare every state.

mod cast;

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;
use novamind_base::formatting::pluralize;

use super::play::show_console;
use super::{Context, Failure, play, print};
use crate::console::effect::Effect;
use crate::insight::open_for_inspection;
use crate::record::folder::runs::find_run_to_read;
use crate::session::{SeekTarget, record_external_read, verify_sealed};
use crate::worker::request::{RecordSource, Request};

#[derive(Debug, Args)]
pub struct Options {
    /// ID of the run, `latest` for the newest run, or the path of a run folder or trajectory
    run: String,
    /// Simulate the run again and compare every recorded state
    #[arg(long)]
    verify: bool,
    /// Start after this week; with --cast: record this week, or the weeks A..B
    #[arg(long, value_name = "N|A..B", conflicts_with = "verify", value_parser = parse_weeks)]
    week: Option<(u32, Option<u32>)>,
    /// Open the x-ray screen, at the end of the record unless --week is given; for debug runs and finished runs
    #[arg(long, conflicts_with = "verify")]
    xray: bool,
    /// Write the replay to this file as an asciicast instead of showing it
    #[arg(long, value_name = "FILE", conflicts_with_all = ["verify", "xray"])]
    cast: Option<PathBuf>,
    #[command(flatten)]
    recording: cast::RecordingOptions,
}

/// Parses a week, or a range of weeks.
fn parse_weeks(text: &str) -> Result<(u32, Option<u32>), String> {
    let number = |text: &str| text.parse::<u32>().map_err(|_| format!("{text} is not a week number"));
    match text.split_once("..") {
        None => Ok((number(text)?, None)),
        Some((first, last)) => match (number(first)?, number(last)?) {
            (first, last) if 1 <= first && first <= last => Ok((first, Some(last))),
            (first, last) => Err(format!(
                "{first}..{last} is not a range of weeks; write the first and the last week, for example 20..24"
            )),
        },
    }
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    match &options.cast {
        Some(file) => {
            cast::record_cast(file, find_record(&options.run), options.week, &options.recording, context)
        }
        None if options.verify => verify(options, context),
        None => show_replay(options, context),
    }
}

fn show_replay(options: &Options, context: &Context) -> Result<(), Failure> {
    let recorded = find_record(&options.run);
    if options.xray {
        check_inspection(&recorded, context)?;
    }
    if !std::io::stdout().is_terminal() || !std::io::stdin().is_terminal() {
        return Err(Failure::usage(
            "a replay needs a terminal; without one, use --verify to simulate the run again and compare every \
             state",
        ));
    }
    let (goal, from) = match (options.week, options.xray) {
        (Some((_, Some(_))), _) => {
            return Err(Failure::usage("a replay starts after one week; a range of weeks needs --cast"));
        }
        (Some((week, None)), _) => (SeekTarget::Week(week), format!("week {week}")),
        (None, true) => (SeekTarget::Last, "the end".to_owned()),
        (None, false) => (SeekTarget::Week(0), "week 0".to_owned()),
    };
    record_view(&recorded, &from, context)?;
    let effect = match options.xray {
        true => Effect::ReplayWithXray(recorded, goal),
        false => Effect::Request(Request::Replay { recorded, goal, follow: false }),
    };
    show_console(&play::Options::default(), Some(effect), context)
}

/// Checks that the hidden state of a record may be inspected.
fn check_inspection(recorded: &RecordSource, context: &Context) -> Result<(), Failure> {
    let folder = match recorded {
        RecordSource::Run(id) => Some(find_run_to_read(&context.runs_folder()?, id)?),
        RecordSource::File(path) => containing_run_folder(path),
    };
    let folder = folder.ok_or_else(|| {
        Failure::usage("the x-ray needs the folder of the run; this trajectory is a single file")
    })?;
    context.check_view_allowed(&folder)?;
    Ok(open_for_inspection(&folder, context.seal_key()?).map(drop)?)
}

/// Returns the path if it is a run folder, otherwise the run folder that contains the file.
fn containing_run_folder(path: &Path) -> Option<PathBuf> {
    let is_run = |folder: &&Path| folder.join("run.toml").is_file();
    Some(path).filter(is_run).or_else(|| path.parent().filter(is_run)).map(Path::to_owned)
}

/// Records in the run that its data was read. Also checks that the data may be read, unless the run is only
/// verified.
fn record_view(recorded: &RecordSource, detail: &str, context: &Context) -> Result<(), Failure> {
    let folder = match recorded {
        RecordSource::Run(id) => find_run_to_read(&context.runs_folder()?, id)?,
        RecordSource::File(path) => match containing_run_folder(path) {
            Some(folder) => folder,
            None => return Ok(()),
        },
    };
    // Verification reveals no data of the run, so no permission is needed.
    if detail == "verify" {
        return Ok(record_external_read(&folder, "replay", detail)?);
    }
    context.authorize_view(&folder, "replay", detail)
}

/// Returns the record at the path `name` if the path exists, otherwise the record of the run with the id
/// `name`.
fn find_record(name: &str) -> RecordSource {
    let path = PathBuf::from(name);
    if path.exists() { RecordSource::File(path) } else { RecordSource::Run(name.to_owned()) }
}

fn verify(options: &Options, context: &Context) -> Result<(), Failure> {
    let recorded = find_record(&options.run);
    record_view(&recorded, "verify", context)?;
    let place = match recorded {
        RecordSource::File(path) => path,
        RecordSource::Run(id) => find_run_to_read(&context.runs_folder()?, &id)?,
    };
    let found = verify_sealed(&place, &context.seal_key()?)?;
    print(&format!(
        "run {}: {}, {} verified, day {}, state {}\n",
        found.run,
        pluralize(found.lines as u32, "line"),
        pluralize(found.states as u32, "state"),
        found.day,
        found.state_hash
    ))
}
