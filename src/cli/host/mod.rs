//! `novamind host`: sessions that participants play in a browser or over ssh, while records stay on this machine.

mod attach;
mod code;
mod links;
mod serve;
mod session;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::Failure;
use crate::host::{HostFolder, ProgramVersion};
use crate::world::MECHANICS;

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Options {
    #[command(subcommand)]
    command: Option<HostCommand>,
    #[command(flatten)]
    serve: serve::ServeOptions,
}

#[derive(Debug, Subcommand)]
enum HostCommand {
    /// Create links and codes for participants and write them to a file
    Links(links::Options),
    /// Set the code for the experimenter's page
    Code {
        /// Folder of the study
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Open a session in this terminal; sshd starts this command for participants
    Attach(attach::Options),
    /// Play one session; the host starts this command
    #[command(hide = true)]
    Session(session::Options),
}

/// Runs the command. `study` is the folder of `--study`.
pub fn run(options: &Options, study: Option<&Path>) -> Result<(), Failure> {
    match &options.command {
        None => serve::run(&options.serve, study),
        Some(HostCommand::Links(options)) => links::run(options),
        Some(HostCommand::Code { folder }) => code::run(folder),
        Some(HostCommand::Attach(options)) => attach::run(options),
        Some(HostCommand::Session(options)) => session::run(options),
    }
}

/// Opens the host folder of a study.
fn open_folder(study: &Path) -> Result<HostFolder, Failure> {
    let program = ProgramVersion { version: env!("CARGO_PKG_VERSION").to_owned(), mechanics: MECHANICS };
    Ok(HostFolder::open_or_create(study, &program)?)
}
