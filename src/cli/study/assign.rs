//! `novamind study assign`: assigns participants to conditions and writes `assignment.csv`.

use std::collections::BTreeSet;
use std::path::PathBuf;

use clap::Args;

use crate::cli::{Failure, print};
use crate::record::error::RunError;
use crate::record::files::{write_atomically, write_private_atomically};
use novamind_study::{ASSIGNMENT_FILE, Assignment, Protocol, STUDY_FILE, SeedPlan};

#[derive(Debug, Args)]
pub struct Options {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Number of participants
    #[arg(long, value_name = "N", required_unless_present = "add", conflicts_with = "add")]
    participants: Option<u32>,
    /// Number of participants to add to the existing assignment; existing rows do not change
    #[arg(long, value_name = "N")]
    add: Option<u32>,
    /// Prefix of the labels
    #[arg(long, value_name = "TEXT", default_value = "P")]
    prefix: String,
    /// Seed of the randomization; equal seeds give equal assignments [default: the seed in study.toml, otherwise 1]
    #[arg(long, value_name = "N")]
    draw: Option<u64>,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let path = options.folder.join(STUDY_FILE);
    let text = std::fs::read_to_string(&path).map_err(RunError::io(&path))?;
    let protocol = Protocol::parse(&path.display().to_string(), &text).map_err(RunError::from)?;
    let draw = randomization_seed(options, &protocol)?;
    let target = options.folder.join(ASSIGNMENT_FILE);
    let (there, more) = match (options.add, Assignment::read(&options.folder)?) {
        (None, Some(_)) => {
            return Err(Failure::failed(format!(
                "{} exists, and participants may have started with it. Add participants with --add N, or move the file away to start over",
                target.display()
            )));
        }
        (Some(_), None) => {
            return Err(Failure::usage(
                "there is no assignment yet: create an assignment with --participants N",
            ));
        }
        (add, there) => (there, add.or(options.participants).unwrap_or_default()),
    };
    let labels = new_labels(there.as_ref(), more, &options.prefix);
    let cells = protocol.seeds.cell_count();
    let seeds = block_seeds(&protocol, there.as_ref(), labels.len())?;
    let made = Assignment::randomize_in_blocks(&labels, &seeds, &protocol.seeds.conditions, draw);
    if let Some(there) = &there
        && !made.rows.starts_with(&there.rows)
    {
        return Err(Failure::failed(format!(
            "the rows of {} were not drawn with seed {draw} for this protocol: give the original seed with --draw, or add the rows by hand. Nothing was changed",
            target.display()
        )));
    }
    let csv = made.to_csv();
    Assignment::parse(&target.display().to_string(), csv.as_bytes()).map_err(RunError::from)?;
    // The file is replaced atomically, because a participant may start a session at the same time.
    // Other accounts of the machine must not read secret seeds.
    let write = match protocol.seeds.plan {
        SeedPlan::Secret => write_private_atomically,
        _ => write_atomically,
    };
    write(&target, csv.as_bytes())?;
    print(&format!(
        "{}: {} participants in blocks of {cells}, drawn with seed {draw}\n{}{}",
        target.display(),
        made.rows.len(),
        incomplete_block_message(made.rows.len(), cells),
        if protocol.seeds.draw.is_none() && draw != 1 {
            format!(
                "add draw = {draw} under [seeds] in {STUDY_FILE} before the first session, so that the protocol contains the seed\n"
            )
        } else {
            String::new()
        }
    ))
}

/// Returns the seeds of a block. Secret seeds are drawn for a new assignment, and read from an existing one.
fn block_seeds(
    protocol: &Protocol,
    there: Option<&Assignment>,
    participants: usize,
) -> Result<Vec<u64>, Failure> {
    let count = protocol.seeds.count.unwrap_or_default() as usize;
    if protocol.seeds.plan != SeedPlan::Secret {
        return Ok(protocol.seeds.block_seeds());
    }
    let cells = protocol.seeds.cell_count();
    if participants < cells {
        return Err(Failure::usage(format!(
            "a block has {cells} participants, and {ASSIGNMENT_FILE} has to contain every secret seed: assign at least {cells} \
             participants"
        )));
    }
    match there {
        Some(assignment) if assignment.seeds().len() == count => Ok(assignment.seeds()),
        Some(assignment) => Err(Failure::failed(format!(
            "{ASSIGNMENT_FILE} has {} seeds, and {STUDY_FILE} has count = {count}: restore the files. Nothing was changed",
            assignment.seeds().len()
        ))),
        None => draw_secret_seeds(count),
    }
}

/// Draws different random seeds. They have 63 bits, because numbers in TOML files and in SQLite have a sign.
fn draw_secret_seeds(count: usize) -> Result<Vec<u64>, Failure> {
    let mut seeds = BTreeSet::new();
    while seeds.len() < count {
        let mut bytes = [0; 8];
        getrandom::fill(&mut bytes).map_err(|error| {
            Failure::failed(format!("the system provides no random numbers: {error}; nothing was written"))
        })?;
        let seed = u64::from_le_bytes(bytes) >> 1;
        seeds.extend(Some(seed).filter(|seed| *seed >= 1 << 32));
    }
    Ok(seeds.into_iter().collect())
}

/// Returns the seed of the randomization. Returns an error if the option contradicts the protocol.
fn randomization_seed(options: &Options, protocol: &Protocol) -> Result<u64, Failure> {
    match (options.draw, protocol.seeds.draw) {
        (Some(asked), Some(protocol_seed)) if asked != protocol_seed => Err(Failure::usage(format!(
            "{STUDY_FILE} sets draw = {protocol_seed}: leave out --draw, or change draw in {STUDY_FILE}"
        ))),
        (asked, protocol_seed) => Ok(asked.or(protocol_seed).unwrap_or(1)),
    }
}

/// Returns the existing labels and `more` new labels with consecutive numbers.
fn new_labels(there: Option<&Assignment>, more: u32, prefix: &str) -> Vec<String> {
    let known: Vec<String> =
        there.iter().flat_map(|assignment| assignment.rows.iter().map(|place| place.label.clone())).collect();
    let numbers: Vec<&str> = known.iter().filter_map(|label| label.strip_prefix(prefix)).collect();
    let last = numbers.iter().filter_map(|number| number.parse::<u32>().ok()).max().unwrap_or(0);
    let digits = match numbers.first() {
        Some(number) => number.len(),
        None => more.to_string().len().max(2),
    };
    let new = (1..=more).map(|number| format!("{prefix}{:0digits$}", last.saturating_add(number)));
    known.iter().cloned().chain(new).collect()
}

/// Returns a remark if the last block is incomplete.
fn incomplete_block_message(places: usize, cells: usize) -> String {
    match places % cells {
        0 => String::new(),
        some => format!(
            "the last block has {some} of {cells} cells; with {} participants every block is complete\n",
            places - some + cells
        ),
    }
}
