//! `novamind host session`: plays one session in a process that the host has started.

use std::path::PathBuf;

use clap::Args;

use crate::cli::Failure;
use crate::host::{limit_session_resources, restrict_to_session, take_terminal};

#[derive(Debug, Args)]
pub struct Options {
    /// Label of the participant
    label: String,
    /// Folder of the session
    #[arg(long)]
    folder: PathBuf,
    /// Do not restrict the process with Landlock
    #[arg(long)]
    without_sandbox: bool,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let failed = |error: &dyn std::fmt::Display| Failure::failed(format!("the session cannot start: {error}"));
    take_terminal().map_err(|error| failed(&error))?;
    limit_session_resources().map_err(|error| failed(&error))?;
    if !options.without_sandbox {
        restrict_to_session(&options.folder).map_err(|error| failed(&error))?;
    }
    crate::cli::play::run_hosted_session(&options.folder, &options.label, false)
}
