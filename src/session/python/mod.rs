//! Python scripts: separate processes that query the session and do not change the run
//! (docs/interfaces/tools.md#scripts-in-python).
//!
//! The process receives its code and the answers to its requests over a socket, as lines of JSON. The session waits
//! for the process and answers its requests on the same thread. The output of a script is recorded with the call or
//! the week, so a replay does not start a process.

#[cfg(unix)]
mod captured_pipe;
#[cfg(unix)]
mod channel;
#[cfg(unix)]
pub(crate) mod confinement;
#[cfg(unix)]
mod interpreter;
#[cfg(unix)]
mod process;
#[cfg(unix)]
pub(crate) mod run;
#[cfg(unix)]
mod script_folder;

use std::time::Duration;

use serde::Deserialize;
use serde_json::Value;

use novamind_tools::Rejection;

/// A request that a script sends to the session.
#[derive(Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(not(unix), allow(dead_code))]
#[serde(tag = "ask", rename_all = "lowercase")]
pub(crate) enum ScriptRequest {
    Query {
        sql: String,
    },
    /// Request for the variables that describe the run.
    Vars,
}

/// The host of a script, which reports whether the player has stopped the script, and answers the requests of the
/// script within the remaining time.
pub(crate) struct ScriptHost<'a> {
    pub(crate) is_stopped: &'a dyn Fn() -> bool,
    pub(crate) answer: &'a mut dyn FnMut(ScriptRequest, Duration) -> Result<Value, Rejection>,
}

/// The output of a script.
#[derive(Debug, Default)]
pub(crate) struct RawScriptOutput {
    /// Query results as tables, or the text that the script printed.
    pub results: String,
    /// Warnings and hints about the results.
    pub remarks: String,
}

pub(crate) fn script_failed(message: impl Into<String>) -> Rejection {
    Rejection::for_field("code", "script_failed", message)
}

/// Rejection message if Python is not allowed.
pub const PYTHON_DISABLED_MESSAGE: &str = "Python is not run for policies or for repeated decisions";

/// Rejects Python unless a player executes the call: replays, policies and lessons must not start programs.
///
/// # Errors
/// The rejection `script_failed`.
pub(crate) fn require_player(is_played: bool) -> Result<(), Rejection> {
    match is_played {
        true => Ok(()),
        false => Err(script_failed(PYTHON_DISABLED_MESSAGE)),
    }
}

#[cfg(not(unix))]
pub(crate) mod run {
    //! Placeholder for systems on which the resources of a process cannot be limited.

    use std::time::Duration;

    use super::{RawScriptOutput, ScriptHost, script_failed};
    use novamind_record::mode::Mode;
    use novamind_tools::Rejection;

    pub(crate) fn run_python(
        _: &str,
        _: Duration,
        _: Mode,
        _: &mut ScriptHost<'_>,
    ) -> Result<RawScriptOutput, Rejection> {
        Err(script_failed("scripts in Python run on Linux and macOS only; write SQL statements instead"))
    }
}
