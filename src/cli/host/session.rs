//! `novamind host session`: plays one session in a process that the host has started.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;

use crate::cli::Failure;
use crate::cli::play::run_hosted_session;
use crate::host::{limit_session_resources, restrict_to_script, restrict_to_session, take_terminal};
use crate::session::restrict_scripts;

/// Time that an earlier process of the session may take to save.
const MAX_SAVING_TIME: Duration = Duration::from_secs(20);

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
    let failed =
        |error: &dyn std::fmt::Display| Failure::failed(format!("the session cannot start: {error}"));
    take_terminal().map_err(|error| failed(&error))?;
    limit_session_resources().map_err(|error| failed(&error))?;
    if !options.without_sandbox {
        restrict_to_session(&options.folder).map_err(|error| failed(&error))?;
        restrict_scripts(|folder| restrict_to_script(folder).map_err(std::io::Error::other));
    }
    let _lock = wait_for_earlier_process(&options.folder).map_err(|error| failed(&error))?;
    run_hosted_session(&options.folder, &options.label, false)
}

/// Waits until an earlier process of the session has ended, which may still be saving after the host was killed. The
/// returned file has to stay open while the session is played.
fn wait_for_earlier_process(session: &Path) -> std::io::Result<File> {
    let lock = File::create(session.join("tmp").join("session.lock"))?;
    let deadline = Instant::now() + MAX_SAVING_TIME;
    loop {
        match lock.try_lock() {
            Ok(()) => return Ok(lock),
            Err(TryLockError::Error(error)) => return Err(error),
            Err(TryLockError::WouldBlock) if Instant::now() > deadline => {
                return Err(std::io::Error::other("an earlier process of the session is still running"));
            }
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(50)),
        }
    }
}
