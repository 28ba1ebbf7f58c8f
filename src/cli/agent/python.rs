//! `novamind agent python`: a program in Python against the run.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use super::server::AgentRun;
use crate::cli::Failure;
use crate::server::Remote;

/// Runs python3 with these words; its exit code is passed on.
pub fn run(words: &[String], own: &AgentRun, remote: &Remote) -> Result<(), Failure> {
    let client = own.client()?;
    let mut command = Command::new("python3");
    command.args(words);
    equip(&mut command, own, remote, &client)?;
    let status = command.status().map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => Failure::failed(
            "python3 is not on the path of this machine: install Python 3.9 or newer, or use `novamind agent call`",
        ),
        _ => Failure::failed(format!("python3 cannot be started: {error}")),
    })?;
    match status.code() {
        Some(0) => Ok(()),
        Some(code) => Err(Failure::code_only(u8::try_from(code).unwrap_or(1))),
        None => Err(Failure::failed("python3 was ended by a signal")),
    }
}

/// Gives a command what it needs to play the run: port, token, name of the run, and the package.
pub fn equip(command: &mut Command, own: &AgentRun, remote: &Remote, client: &Path) -> Result<(), Failure> {
    let mut path = vec![client.to_owned()];
    if let Some(others) = std::env::var_os("PYTHONPATH") {
        path.extend(std::env::split_paths(&others));
    }
    let path: OsString = std::env::join_paths(path).map_err(|error| {
        Failure::usage(format!("the folder of the run cannot be put on PYTHONPATH: {error}"))
    })?;
    command.env("PYTHONPATH", path).env("NOVAMIND_API_PORT", remote.port.to_string());
    command.env("NOVAMIND_RUN", &own.id);
    // Commands of the agent find the run, wherever they are started.
    command
        .env("NOVAMIND_RUNS", own.folder.parent().unwrap_or(&own.folder))
        .env_remove("NOVAMIND_PARTICIPANT");
    match &remote.token {
        Some(token) => command.env("NOVAMIND_API_TOKEN", token),
        None => command.env_remove("NOVAMIND_API_TOKEN"),
    };
    Ok(())
}
