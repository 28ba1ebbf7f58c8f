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
    run_hosted_session(&options.folder, &options.label, false)
}

/// Plays the session. Replaced when the console has a hosted mode.
fn run_hosted_session(folder: &std::path::Path, _label: &str, _plain: bool) -> Result<(), Failure> {
    let context = crate::cli::Context {
        configuration: crate::record::folder::configuration::Configuration::bundled(),
        runs: Some(folder.join("runs")),
        participant: None,
        has_explicit_runs_folder: true,
        study_folder: None,
        is_experimenter: false,
    };
    crate::cli::play::guide_participant(&folder.join("study"), &crate::cli::play::Options::default(), &context)
}
