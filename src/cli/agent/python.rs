//! `novamind agent python`: runs a Python program that plays the run.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use super::server::AgentRun;
use crate::cli::Failure;
use crate::server::RemoteServer;

/// Runs python3 and exits with the exit code of python3.
pub fn run(words: &[String], agent_run: &AgentRun, remote: &RemoteServer) -> Result<(), Failure> {
    let client = agent_run.write_client()?;
    let mut command = Command::new("python3");
    command.args(words);
    set_environment(&mut command, agent_run, remote, &client)?;
    let status = command.status().map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => Failure::failed(
            "python3 is not on the PATH: install Python 3.9 or newer, or use `novamind agent call`",
        ),
        _ => Failure::failed(format!("cannot start python3: {error}")),
    })?;
    match status.code() {
        Some(0) => Ok(()),
        Some(code) => Err(Failure::code_only(u8::try_from(code).unwrap_or(1))),
        None => Err(Failure::failed("a signal ended python3")),
    }
}

/// Sets the environment that a program needs to play the run: port, token, run id and Python package.
pub fn set_environment(
    command: &mut Command,
    agent_run: &AgentRun,
    remote: &RemoteServer,
    client: &Path,
) -> Result<(), Failure> {
    let mut path = vec![client.to_owned()];
    if let Some(others) = std::env::var_os("PYTHONPATH") {
        path.extend(std::env::split_paths(&others));
    }
    let path: OsString = std::env::join_paths(path).map_err(|error| {
        Failure::usage(format!("cannot add the folder of the run to PYTHONPATH: {error}"))
    })?;
    command.env("PYTHONPATH", path).env("NOVAMIND_API_PORT", remote.port.to_string());
    command.env("NOVAMIND_RUN", &agent_run.id);
    // `novamind agent` finds the run from any working directory.
    command
        .env("NOVAMIND_RUNS", agent_run.folder.parent().unwrap_or(&agent_run.folder))
        .env_remove("NOVAMIND_PARTICIPANT");
    match &remote.token {
        Some(token) => command.env("NOVAMIND_API_TOKEN", token),
        None => command.env_remove("NOVAMIND_API_TOKEN"),
    };
    Ok(())
}
