//! `novamind lab diff`: compares two runs on a day.

use clap::Args;
use serde_json::json;

use crate::cli::{Context, Failure, print};
use crate::formatting::escape_control_characters;
use crate::insight::{Inspect, open_for_inspection};
use crate::record::folder::runs::find_run_to_read;
use crate::report::inspection::{describe_run_difference, difference_to_json};
use crate::session::Session;

#[derive(Debug, Args)]
pub struct Options {
    /// First run; a debug run or a finished run
    #[arg(value_name = "RUN_A")]
    one: String,
    /// Second run; a debug run or a finished run
    #[arg(value_name = "RUN_B")]
    other: String,
    /// Day to compare [default: the first day on which the runs differ]
    #[arg(value_name = "DAY")]
    day: Option<u32>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Prints the differences between two runs. The only change to the runs is a record of the inspection.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let runs = context.runs_folder()?;
    let open = |name: &str| -> Result<Session, Failure> {
        let folder = find_run_to_read(&runs, name)?;
        context.check_view_allowed(&folder)?;
        Ok(open_for_inspection(&folder, context.seal_key()?)?)
    };
    let mut one = open(&options.one)?;
    if one.folder() == Some(&*find_run_to_read(&runs, &options.other)?) {
        return Err(Failure::usage(
            "give two different runs; to compare two days of one run, use `diff DAY DAY` in plain mode",
        ));
    }
    let mut other = open(&options.other)?;
    let found = one.inspect().compare_with_run(&mut other, options.day);
    let found = found.map_err(|rejection| Failure::failed(rejection.message))?;
    let ids = [&one, &other].map(|run| run.manifest().id.clone());
    if options.json {
        let object = json!({
            "runs": ids,
            "last_day": found.last_day,
            "first_day": found.first_day,
            "day": found.difference.as_ref().map(|day_difference| day_difference.days.0),
            "difference": found.difference.as_ref().map(difference_to_json),
        });
        return print(&(serde_json::to_string_pretty(&object).unwrap_or_default() + "\n"));
    }
    let lines = describe_run_difference(&found, (&ids[0], &ids[1]));
    print(&escape_control_characters(&(lines.join("\n") + "\n")))
}
