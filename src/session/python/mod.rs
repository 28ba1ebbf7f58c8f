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
mod run;

use novamind_tools::Refusal;

/// Says why a script in Python was not run, or not to its end.
fn failed(message: impl Into<String>) -> Refusal {
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
mod run {
    //! Systems on which a process cannot be held within bounds.

    use std::time::Duration;

    use super::failed;
    use crate::play::scripts::Said;
    use crate::state::Session;
    use novamind_tools::Refusal;

    impl Session {
        /// Refuses a script in Python.
        pub(crate) fn run_python(&mut self, _: &str, _: Duration, _: bool) -> Result<Said, Refusal> {
            Err(failed("scripts in Python run on Linux and macOS only; write SQL statements instead"))
        }
    }
}
