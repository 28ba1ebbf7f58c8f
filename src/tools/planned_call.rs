//! Planned calls: their effects and their results, before random draws.

use serde::Serialize;
use serde_json::Value;

use super::notebook::NotebookChange;
use super::rejection::Rejection;
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::settings::SettingsChange;

/// An accepted call that is not applied yet.
pub struct PlannedCall<A> {
    /// Command for the simulator.
    pub command: Command,
    /// Change to the notebook.
    pub notebook_change: Option<NotebookChange>,
    /// Row of the settings in the database, if it differs from the settings.
    pub settings_row: Option<Value>,
    /// Result.
    pub reply: Reply<A>,
}

/// Builds a result from the resolved command; `None` for a command of another kind.
type AnswerBuilder<A> = Box<dyn FnOnce(&ResolvedCommand) -> Option<A>>;

/// Result of a planned call.
pub enum Reply<A> {
    /// A result without random draws.
    Immediate(A),
    /// A result from the random draws of the command.
    FromDraws(AnswerBuilder<A>),
    /// A result from the output of a script that the session runs.
    FromScript(Script, Box<dyn FnOnce(ScriptOutput) -> A>),
}

/// A script to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Script {
    /// Statements, or Python.
    pub code: String,
    /// Time limit of the whole script, seconds.
    pub timeout_seconds: f64,
}

/// Output of a script.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ScriptOutput {
    /// 0 if it ran to its end.
    pub returncode: i32,
    /// Results as tables, or printed text.
    pub stdout: String,
    /// Warnings and hints.
    pub stderr: String,
}

impl<A> PlannedCall<A> {
    fn new(command: Command, reply: Reply<A>) -> PlannedCall<A> {
        PlannedCall { command, notebook_change: None, settings_row: None, reply }
    }

    /// Returns a call without effects.
    pub fn read_only(answer: A) -> PlannedCall<A> {
        PlannedCall::new(Command::None, Reply::Immediate(answer))
    }

    /// Returns a call with a command without random draws.
    pub fn with_command(command: Command, answer: A) -> PlannedCall<A> {
        PlannedCall::new(command, Reply::Immediate(answer))
    }

    /// Returns a call that changes settings.
    pub fn with_settings_change(change: SettingsChange, answer: A) -> PlannedCall<A> {
        PlannedCall::with_command(Command::Set(change), answer)
    }

    /// Returns a call whose result depends on the random draws of its command.
    pub fn with_draws(
        command: Command,
        answer: impl FnOnce(&ResolvedCommand) -> Option<A> + 'static,
    ) -> PlannedCall<A> {
        PlannedCall::new(command, Reply::FromDraws(Box::new(answer)))
    }

    /// Returns a call that changes the notebook.
    pub fn with_notebook_change(change: NotebookChange, answer: A) -> PlannedCall<A> {
        PlannedCall { notebook_change: Some(change), ..PlannedCall::read_only(answer) }
    }

    /// Sets the row of the settings in the database.
    pub fn with_settings_row(self, row: Value) -> PlannedCall<A> {
        PlannedCall { settings_row: Some(row), ..self }
    }
}

impl PlannedCall<ScriptOutput> {
    /// Returns a call that runs a script.
    pub fn with_script(script: Script) -> PlannedCall<ScriptOutput> {
        PlannedCall::new(Command::None, Reply::FromScript(script, Box::new(|output| output)))
    }
}

impl<A: 'static> PlannedCall<A> {
    /// Converts the type of the result.
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
    /// Returns the result for a resolved command. `run` runs the script, if there is one.
    ///
    /// # Errors
    /// The rejection of the script.
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

    /// Returns the result if it needs no script.
    pub fn into_answer_without_script(self, resolved: &ResolvedCommand) -> Option<A> {
        let refuse = |_: &Script| Err(Rejection::new("script_failed", "scripts are not run here"));
        self.into_answer(resolved, refuse).ok()
    }
}
