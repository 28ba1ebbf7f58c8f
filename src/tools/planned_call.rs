//! Planned tool calls: the effect and the result of a call before its random draws.

use serde::Serialize;
use serde_json::Value;

use super::notebook::NotebookChange;
use super::rejection::Rejection;
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::settings::SettingsChange;

/// An accepted tool call that has not been applied yet.
pub struct PlannedCall<A> {
    /// Command that the simulator executes.
    pub command: Command,
    /// Change to the notebook; `None` if the call leaves the notebook unchanged.
    pub notebook_change: Option<NotebookChange>,
    /// Settings row for the database, if it differs from the settings of the simulator.
    pub settings_row: Option<Value>,
    /// Result of the call, or the function that computes it.
    pub reply: Reply<A>,
}

/// A function that builds a result from the resolved command. Returns `None` for a command of another kind.
type AnswerBuilder<A> = Box<dyn FnOnce(&ResolvedCommand) -> Option<A>>;

/// The result of a planned call.
pub enum Reply<A> {
    /// A result that does not depend on random draws.
    Immediate(A),
    /// A result that is built from the random draws of the command.
    FromDraws(AnswerBuilder<A>),
    /// A result that is built from the output of a script. The session runs the script.
    FromScript(Script, Box<dyn FnOnce(ScriptOutput) -> A>),
}

/// A script that the session runs for a call.
#[derive(Debug, Clone, PartialEq)]
pub struct Script {
    /// SQL statements or Python code.
    pub code: String,
    /// Time limit of the whole script, in seconds.
    pub timeout_seconds: f64,
}

/// The exit code and output of a script.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ScriptOutput {
    /// Exit code; 0 if the script ran to its end.
    pub returncode: i32,
    /// Query results as tables, or the output of Python.
    pub stdout: String,
    /// Warnings and hints of the script.
    pub stderr: String,
}

impl<A> PlannedCall<A> {
    fn new(command: Command, reply: Reply<A>) -> PlannedCall<A> {
        PlannedCall { command, notebook_change: None, settings_row: None, reply }
    }

    /// Returns a planned call without effects.
    pub fn read_only(answer: A) -> PlannedCall<A> {
        PlannedCall::new(Command::None, Reply::Immediate(answer))
    }

    /// Returns a planned call whose command draws no random numbers.
    pub fn with_command(command: Command, answer: A) -> PlannedCall<A> {
        PlannedCall::new(command, Reply::Immediate(answer))
    }

    /// Returns a planned call that changes settings.
    pub fn with_settings_change(change: SettingsChange, answer: A) -> PlannedCall<A> {
        PlannedCall::with_command(Command::Set(change), answer)
    }

    /// Returns a planned call whose result depends on the random draws of its command.
    pub fn with_draws(
        command: Command,
        answer: impl FnOnce(&ResolvedCommand) -> Option<A> + 'static,
    ) -> PlannedCall<A> {
        PlannedCall::new(command, Reply::FromDraws(Box::new(answer)))
    }

    /// Returns a planned call that changes the notebook.
    pub fn with_notebook_change(change: NotebookChange, answer: A) -> PlannedCall<A> {
        PlannedCall { notebook_change: Some(change), ..PlannedCall::read_only(answer) }
    }

    /// Sets the settings row for the database.
    pub fn with_settings_row(self, row: Value) -> PlannedCall<A> {
        PlannedCall { settings_row: Some(row), ..self }
    }
}

impl PlannedCall<ScriptOutput> {
    /// Returns a planned call that runs a script.
    pub fn with_script(script: Script) -> PlannedCall<ScriptOutput> {
        PlannedCall::new(Command::None, Reply::FromScript(script, Box::new(|output| output)))
    }
}

impl<A: 'static> PlannedCall<A> {
    /// Converts the result of the planned call to another type.
    pub(super) fn map_answer<B: 'static>(self, convert: fn(A) -> B) -> PlannedCall<B> {
        let PlannedCall { command, notebook_change: change, settings_row: row, reply } = self;
        let reply = match reply {
            Reply::Immediate(answer) => Reply::Immediate(convert(answer)),
            Reply::FromDraws(answer) => {
                Reply::FromDraws(Box::new(move |resolved| answer(resolved).map(convert)))
            }
            Reply::FromScript(script, answer) => {
                Reply::FromScript(script, Box::new(move |output| convert(answer(output))))
            }
        };
        PlannedCall { command, notebook_change: change, settings_row: row, reply }
    }
}

impl<A> Reply<A> {
    /// Returns the result for a resolved command. `run` executes the script of the call, if the call has a script.
    ///
    /// # Errors
    /// Returns the rejection of the script.
    pub fn into_answer(
        self,
        resolved: &ResolvedCommand,
        run: impl FnOnce(&Script) -> Result<ScriptOutput, Rejection>,
    ) -> Result<A, Rejection> {
        match self {
            Reply::Immediate(answer) => Ok(answer),
            Reply::FromDraws(answer) => {
                Ok(answer(resolved).expect("a resolved command has the kind of its command"))
            }
            Reply::FromScript(script, answer) => run(&script).map(answer),
        }
    }

    /// Returns the result, or `None` if the result needs a script.
    pub fn into_answer_without_script(self, resolved: &ResolvedCommand) -> Option<A> {
        let refuse = |_: &Script| Err(Rejection::new("script_failed", "scripts are not run here"));
        self.into_answer(resolved, refuse).ok()
    }
}
