//! What a call would do, and what it says once chance has been resolved.

use serde::Serialize;
use serde_json::Value;

use super::notebook::NotebookChange;
use super::refusal::Refusal;
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::settings::SettingsChange;

/// An accepted call that has not happened yet.
pub struct Planned<A> {
    /// What it does to the world.
    pub command: Command,
    /// What it keeps or forgets with the run.
    pub change: Option<NotebookChange>,
    /// The settings family as its row shows it, where that is not the family itself.
    pub row: Option<Value>,
    /// What it says.
    pub reply: Reply<A>,
}

/// Makes an answer from what was drawn; none if the command is another one's.
type Teller<A> = Box<dyn FnOnce(&ResolvedCommand) -> Option<A>>;

/// What a call says.
pub enum Reply<A> {
    /// No chance is involved.
    Known(A),
    /// Made from what was drawn.
    Drawn(Teller<A>),
    /// Made from what a script says that the session runs.
    Output(Script, Box<dyn FnOnce(ScriptOutput) -> A>),
}

/// A script to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Script {
    /// Statements, or Python.
    pub code: String,
    /// Time for all of it, seconds.
    pub seconds: f64,
}

/// What a script said.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ScriptOutput {
    /// 0: it ran to its end.
    pub returncode: i32,
    /// The results as tables, or what was printed.
    pub stdout: String,
    /// Warnings and hints.
    pub stderr: String,
}

impl<A> Planned<A> {
    fn new(command: Command, reply: Reply<A>) -> Planned<A> {
        Planned { command, change: None, row: None, reply }
    }

    /// A call that only answers.
    pub fn reading(answer: A) -> Planned<A> {
        Planned::new(Command::None, Reply::Known(answer))
    }

    /// A call that does what needs no chance.
    pub fn doing(command: Command, answer: A) -> Planned<A> {
        Planned::new(command, Reply::Known(answer))
    }

    /// A call that leaves a settings family.
    pub fn setting(change: SettingsChange, answer: A) -> Planned<A> {
        Planned::doing(Command::Set(change), answer)
    }

    /// A call whose answer is made from what its command draws.
    pub fn drawing(
        command: Command,
        answer: impl FnOnce(&ResolvedCommand) -> Option<A> + 'static,
    ) -> Planned<A> {
        Planned::new(command, Reply::Drawn(Box::new(answer)))
    }

    /// A call that keeps or forgets something with the run.
    pub fn keeping(change: NotebookChange, answer: A) -> Planned<A> {
        Planned { change: Some(change), ..Planned::reading(answer) }
    }

    /// The same call with its own row of settings.
    pub fn with_row(self, row: Value) -> Planned<A> {
        Planned { row: Some(row), ..self }
    }
}

impl Planned<ScriptOutput> {
    /// A call that runs a script.
    pub fn running(script: Script) -> Planned<ScriptOutput> {
        Planned::new(Command::None, Reply::Output(script, Box::new(|output| output)))
    }
}

impl<A: 'static> Planned<A> {
    /// The same call with its answer in another type.
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
    /// The answer, given what was drawn and somebody who runs scripts.
    ///
    /// # Errors
    /// What speaks against the script.
    pub fn tell(
        self,
        resolved: &ResolvedCommand,
        run: impl FnOnce(&Script) -> Result<ScriptOutput, Refusal>,
    ) -> Result<A, Refusal> {
        match self {
            Reply::Known(answer) => Ok(answer),
            Reply::Drawn(answer) => Ok(answer(resolved).expect("a command is resolved as what it is")),
            Reply::Output(script, answer) => run(&script).map(answer),
        }
    }

    /// The answer, where no script is run for it.
    pub fn without_running(self, resolved: &ResolvedCommand) -> Option<A> {
        let refuse = |_: &Script| Err(Refusal::new("script_failed", "scripts are not run here"));
        self.tell(resolved, refuse).ok()
    }
}
