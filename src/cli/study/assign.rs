//! `novamind study assign`: `assignment.csv`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::{Failure, print};
use crate::record::error::RunError;
use crate::record::files::write_whole;
use novamind_study::{ASSIGNMENT_FILE, Assignment, Protocol, STUDY_FILE};

/// Options of `study assign`.
#[derive(Debug, Args)]
pub struct Options {
    /// Folder of the study.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// How many participants.
    #[arg(long, value_name = "N", required_unless_present = "add", conflicts_with = "add")]
    participants: Option<u32>,
    /// How many participants to add to the assignment that is there; its rows stay as they are.
    #[arg(long, value_name = "N")]
    add: Option<u32>,
    /// What labels begin with.
    #[arg(long, value_name = "TEXT", default_value = "P")]
    prefix: String,
    /// Seed of the randomisation: the same seed gives the same assignment [default: that of study.toml, or 1].
    #[arg(long, value_name = "N")]
    draw: Option<u64>,
}

/// Runs the command.
pub fn run(options: &Options) -> Result<(), Failure> {
    let path = options.folder.join(STUDY_FILE);
    let text = std::fs::read_to_string(&path).map_err(RunError::io(&path))?;
    let protocol = Protocol::read(&path.display().to_string(), &text).map_err(RunError::from)?;
    let draw = drawn_with(options, &protocol)?;
    let target = options.folder.join(ASSIGNMENT_FILE);
    let (there, more) = match (options.add, Assignment::read(&options.folder)?) {
        (None, Some(_)) => {
            return Err(Failure::failed(format!(
                "{} exists: participants may have begun with it. --add N adds to it; move it away to assign anew",
                target.display()
            )));
        }
        (Some(_), None) => {
            return Err(Failure::usage("there is no assignment yet: --participants N makes one"));
        }
        (add, there) => (there, add.or(options.participants).unwrap_or_default()),
    };
    let labels = labels(there.as_ref(), more, &options.prefix);
    let (seeds, cells) = (protocol.seeds.of_block(), protocol.seeds.cells());
    let made = Assignment::in_blocks(&labels, &seeds, &protocol.seeds.conditions, draw);
    if let Some(there) = &there
        && !made.places.starts_with(&there.places)
    {
        return Err(Failure::failed(format!(
            "the rows of {} are not those that are drawn with {draw} for this protocol: give the --draw they were made with, or \
             write the rows to add by hand. Nothing was changed",
            target.display()
        )));
    }
    let csv = made.as_csv();
    Assignment::parse(&target.display().to_string(), csv.as_bytes()).map_err(RunError::from)?;
    // As a whole: participants may be coming meanwhile.
    write_whole(&target, csv.as_bytes())?;
    print(&format!(
        "{}: {} participants in blocks of {cells}, drawn with {draw}\n{}{}",
        target.display(),
        made.places.len(),
        incomplete(made.places.len(), cells),
        if protocol.seeds.draw.is_none() && draw != 1 {
            format!(
                "put draw = {draw} under [seeds] of {STUDY_FILE} before the first session: the protocol names it then\n"
            )
        } else {
            String::new()
        }
    ))
}

/// The seed of the randomisation; that of the protocol cannot be passed over.
fn drawn_with(options: &Options, protocol: &Protocol) -> Result<u64, Failure> {
    match (options.draw, protocol.seeds.draw) {
        (Some(asked), Some(own)) if asked != own => Err(Failure::usage(format!(
            "{STUDY_FILE} says draw = {own}: leave --draw out, or change it there"
        ))),
        (asked, own) => Ok(asked.or(own).unwrap_or(1)),
    }
}

/// The labels that are there, and so many more with numbers that go on.
fn labels(there: Option<&Assignment>, more: u32, prefix: &str) -> Vec<String> {
    let known: Vec<String> =
        there.iter().flat_map(|own| own.places.iter().map(|place| place.label.clone())).collect();
    let numbers: Vec<&str> = known.iter().filter_map(|label| label.strip_prefix(prefix)).collect();
    let last = numbers.iter().filter_map(|number| number.parse::<u32>().ok()).max().unwrap_or(0);
    let digits = match numbers.first() {
        Some(number) => number.len(),
        None => more.to_string().len().max(2),
    };
    let new = (1..=more).map(|number| format!("{prefix}{:0digits$}", last.saturating_add(number)));
    known.iter().cloned().chain(new).collect()
}

/// What is missing of the last block.
fn incomplete(places: usize, cells: usize) -> String {
    match places % cells {
        0 => String::new(),
        some => format!(
            "the last block has {some} of {cells} cells: with {} participants every block is whole\n",
            places - some + cells
        ),
    }
}
