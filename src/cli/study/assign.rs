//! `novamind study assign`: `assignment.csv`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::{Failure, print};
use crate::session::{ASSIGNMENT_FILE, Assignment, Protocol, RunError, STUDY_FILE};

/// Options of `study assign`.
#[derive(Debug, Args)]
pub struct Options {
    /// Folder of the study.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// How many participants.
    #[arg(long, value_name = "N")]
    participants: u32,
    /// What labels begin with.
    #[arg(long, value_name = "TEXT", default_value = "P")]
    prefix: String,
    /// Seed of the randomisation: the same seed gives the same assignment.
    #[arg(long, value_name = "N", default_value_t = 1)]
    draw: u64,
}

/// Runs the command.
pub fn run(options: &Options) -> Result<(), Failure> {
    let path = options.folder.join(STUDY_FILE);
    let text = std::fs::read_to_string(&path).map_err(RunError::io(&path))?;
    let protocol = Protocol::read(&path.display().to_string(), &text).map_err(RunError::from)?;
    let target = options.folder.join(ASSIGNMENT_FILE);
    if target.exists() {
        return Err(Failure::failed(format!(
            "{} exists: participants may have begun with it. Move it away to assign anew",
            target.display()
        )));
    }
    let digits = options.participants.to_string().len().max(2);
    let label = |number: u32| format!("{}{number:0digits$}", options.prefix);
    let labels: Vec<String> = (1..=options.participants).map(label).collect();
    let seeds = match protocol.seeds.block.as_slice() {
        [] => protocol.seeds.seed.into_iter().collect(),
        block => block.to_vec(),
    };
    let made = Assignment::in_blocks(&labels, &seeds, &protocol.seeds.conditions, options.draw);
    let csv = made.as_csv();
    Assignment::parse(&target.display().to_string(), csv.as_bytes()).map_err(RunError::from)?;
    std::fs::write(&target, csv).map_err(RunError::io(&target))?;
    let cells = seeds.len().max(1) * protocol.seeds.conditions.len().max(1);
    print(&format!(
        "{}: {} participants in blocks of {cells}, drawn with {}\n",
        target.display(),
        made.places.len(),
        options.draw
    ))
}
