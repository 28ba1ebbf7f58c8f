//! `novamind study`: commands for experimenters.

mod anonymise;
mod assign;
mod audit;
mod check;
pub(super) mod code;
mod collect;
mod key;
mod new;
mod protocol;
mod watch;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::{Context, Failure, play};
use novamind_study::Study;

#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    command: StudyCommand,
}

#[derive(Debug, Subcommand)]
enum StudyCommand {
    /// Create the folder of a new study, with a protocol to edit
    New(new::Options),
    /// Check the protocol of a study and whether this machine is ready for it
    Check {
        /// Folder of the study
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Assign labels to conditions and seeds, in random order within blocks
    Assign(assign::Options),
    /// Check the records of a study: damaged or missing runs, other protocols, changed clocks, inspections of hidden state
    Audit(audit::Options),
    /// Write the tables of a study without data that identifies participants
    #[command(name = "anonymize", alias = "anonymise")]
    Anonymise(anonymise::Options),
    /// Collect the runs of all machines without duplicates, verify them, and write their tables
    Collect(collect::Options),
    /// Watch the sessions in progress
    Watch(watch::Options),
    /// Print the protocol as text, with every measure and its definition, ready for preregistration
    Protocol {
        /// Folder of the study
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Create the keys of a study: lab.key signs archives, lab.pub verifies signatures, and seal.key seals snapshots
    Key {
        /// Folder of the study
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Print the line of study.toml that requires an experimenter's code
    Code,
    /// Guide a participant through the study; the same as `novamind --study DIR`
    Start {
        /// Folder of the study
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        #[command(flatten)]
        play: play::Options,
    },
}

/// Reads a study, and prints warnings about removed settings to standard error.
fn read_study(folder: &Path) -> Result<Study, Failure> {
    let study = Study::load(folder)?;
    study.protocol.removed_settings().iter().for_each(|words| eprintln!("novamind: study.toml: {words}"));
    Ok(study)
}

pub fn run(options: Options, context: &Context) -> Result<(), Failure> {
    match options.command {
        StudyCommand::New(options) => new::run(&options),
        StudyCommand::Check { folder } => check::run(&folder, context),
        StudyCommand::Anonymise(options) => anonymise::run(&options),
        StudyCommand::Assign(options) => assign::run(&options),
        StudyCommand::Audit(options) => audit::run(&options, context),
        StudyCommand::Collect(options) => collect::run(&options, context),
        StudyCommand::Key { folder } => key::run(&folder),
        StudyCommand::Watch(options) => watch::run(&options, context),
        StudyCommand::Protocol { folder } => protocol::run(&folder, context),
        StudyCommand::Code => code::run(),
        StudyCommand::Start { folder, play } => play::guide_participant(&folder, &play, context),
    }
}
