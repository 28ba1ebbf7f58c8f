//! Scripts in Python: a process of their own, which asks the session while it runs and changes nothing
//! (docs/interfaces/tools.md#scripts-in-python).
//!
//! The process gets its code and the answers to its questions over a socket, line by line as JSON; the session waits for it and
//! answers, so no server has to run and no thread waits for another. What a script says is recorded with the call, or with the
//! week: whatever reads a record starts no process.

#[cfg(unix)]
mod captured;
#[cfg(unix)]
mod channel;
#[cfg(unix)]
mod empty_folder;
#[cfg(unix)]
mod interpreter;
#[cfg(unix)]
mod process;
#[cfg(unix)]
pub(crate) mod run;

use std::time::Duration;

use serde::Deserialize;
use serde_json::Value;

use novamind_tools::Refusal;

/// What a script asks.
#[derive(Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(not(unix), allow(dead_code))]
#[serde(tag = "ask", rename_all = "lowercase")]
pub(crate) enum ScriptRequest {
    /// A statement to the database.
    Query {
        /// The statement.
        sql: String,
    },
    /// Where the run stands.
    Vars,
}

/// What runs a script: whether the player has stopped it, and the answers to its requests, given the time that is left.
pub(crate) struct ScriptHost<'a> {
    pub(crate) is_stopped: &'a dyn Fn() -> bool,
    pub(crate) answer: &'a mut dyn FnMut(ScriptRequest, Duration) -> Result<Value, Refusal>,
}

/// What code said.
#[derive(Debug, Default)]
pub(crate) struct Said {
    /// Results as tables, or what was printed.
    pub results: String,
    /// Warnings and hints.
    pub remarks: String,
}

/// Says why a script in Python was not run, or not to its end.
pub(crate) fn failed(message: impl Into<String>) -> Refusal {
    Refusal::at("code", "script_failed", message)
}

/// What is said where a program in Python is not run.
pub const PYTHON_NOT_RUN: &str =
    "Python is not run for policies, nor for decisions that somebody made elsewhere";

/// Refuses where nobody plays: a record, a policy or a lesson must not start programs.
///
/// # Errors
/// `script_failed`.
pub(crate) fn refuse_unless_played(is_played: bool) -> Result<(), Refusal> {
    match is_played {
        true => Ok(()),
        false => Err(failed(PYTHON_NOT_RUN)),
    }
}

#[cfg(not(unix))]
pub(crate) mod run {
    //! Systems on which a process cannot be held within bounds.

    use std::time::Duration;

    use super::{Said, ScriptHost, failed};
    use novamind_record::mode::Mode;
    use novamind_tools::Refusal;

    /// Refuses a script in Python.
    pub(crate) fn run_python(_: &str, _: Duration, _: Mode, _: &mut ScriptHost<'_>) -> Result<Said, Refusal> {
        Err(failed("scripts in Python run on Linux and macOS only; write SQL statements instead"))
    }
}
