//! Planned calls: their effects and their results, before random draws.

use serde::Serialize;
use serde_json::Value;

use super::notebook::NotebookChange;
use super::refusal::Refusal;
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::settings::SettingsChange;

/// An accepted call that is not applied yet.
pub struct Planned<A> {
    /// Command for the simulator.
    pub command: Command,
    /// Change of the notebook.
    pub change: Option<NotebookChange>,
    /// Row of the settings in the database, if it differs from the settings.
    pub row: Option<Value>,
    /// Result.
    pub reply: Reply<A>,
}

/// Builds a result from the resolved command; `None` for a command of another kind.
type Teller<A> = Box<dyn FnOnce(&ResolvedCommand) -> Option<A>>;

/// Result of a planned call.
pub enum Reply<A> {
    /// A result without random draws.
    Known(A),
    /// A result from the random draws of the command.
    Drawn(Teller<A>),
    /// A result from the output of a script that the session runs.
    Output(Script, Box<dyn FnOnce(ScriptOutput) -> A>),
}

/// A script to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Script {
    /// Statements, or Python.
    pub code: String,
    /// Time limit of the whole script, seconds.
    pub seconds: f64,
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

impl<A> Planned<A> {
    fn new(command: Command, reply: Reply<A>) -> Planned<A> {
        Planned { command, change: None, row: None, reply }
    }

    /// Returns a call without effects.
    pub fn reading(answer: A) -> Planned<A> {
        Planned::new(Command::None, Reply::Known(answer))
    }

    /// Returns a call with a command without random draws.
    pub fn doing(command: Command, answer: A) -> Planned<A> {
        Planned::new(command, Reply::Known(answer))
    }

    /// Returns a call that changes settings.
    pub fn setting(change: SettingsChange, answer: A) -> Planned<A> {
        Planned::doing(Command::Set(change), answer)
    }

    /// Returns a call whose result depends on the random draws of its command.
    pub fn drawing(
        command: Command,
        answer: impl FnOnce(&ResolvedCommand) -> Option<A> + 'static,
    ) -> Planned<A> {
        Planned::new(command, Reply::Drawn(Box::new(answer)))
    }

    /// Returns a call that changes the notebook.
    pub fn keeping(change: NotebookChange, answer: A) -> Planned<A> {
        Planned { change: Some(change), ..Planned::reading(answer) }
    }

    /// Sets the row of the settings in the database.
    pub fn with_row(self, row: Value) -> Planned<A> {
        Planned { row: Some(row), ..self }
    }
}

impl Planned<ScriptOutput> {
    /// Returns a call that runs a script.
    pub fn running(script: Script) -> Planned<ScriptOutput> {
        Planned::new(Command::None, Reply::Output(script, Box::new(|output| output)))
    }
}

impl<A: 'static> Planned<A> {
    /// Converts the type of the result.
    pub(super) fn map<B: 'static>(self, convert: fn(A) -> B) -> Planned<B> {
        let Planned { command, change, row, reply } = self;
        let reply = match reply {
            Reply::Known(answer) => Reply::Known(convert(answer)),
            Reply::Drawn(answer) => Reply::Drawn(Box::new(move |resolved| answer(resolved).map(convert))),
            Reply::Output(script, answer) => {
                Reply::Output(script, Box::new(move |output| convert(answer(output))))
            }
        };
        Planned { command, change, row, reply }
    }
}

impl<A> Reply<A> {
    /// Returns the result for a resolved command. `run` runs the script, if there is one.
    ///
    /// # Errors
    /// The rejection of the script.
    pub fn tell(
        self,
        resolved: &ResolvedCommand,
        run: impl FnOnce(&Script) -> Result<ScriptOutput, Refusal>,
    ) -> Result<A, Refusal> {
        match self {
            Reply::Known(answer) => Ok(answer),
            Reply::Drawn(answer) => {
                Ok(answer(resolved).expect("a resolved command has the kind of its command"))
            }
            Reply::Output(script, answer) => run(&script).map(answer),
        }
    }

    /// Returns the result if it needs no script.
    pub fn without_running(self, resolved: &ResolvedCommand) -> Option<A> {
        let refuse = |_: &Script| Err(Refusal::new("script_failed", "scripts are not run here"));
        self.tell(resolved, refuse).ok()
    }
}
