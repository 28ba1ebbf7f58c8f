use serde_json::Value;

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Refusal, Spec, Task, Tool, ToolId, View, When,
};
use super::{LONGEST_SECONDS, find};
use crate::world::command::{Command, ResolvedCommand};

/// Runs a stored script.
pub struct RunScript;

static SPEC: Spec = Spec {
    id: ToolId::RunScript,
    code: "RUN",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Run a stored script",
    arguments: &[Argument {
        name: "name",
        alias: None,
        kind: ArgumentKind::Text,
        required: true,
        unit: "",
        doc: "name of the script",
    }],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &["script_not_found", "script_failed", "script_timeout"],
    returns: &[
        Output { name: "returncode", kind: "integer", doc: "0: every statement was answered" },
        Output { name: "stdout", kind: "text", doc: "the results as tables, the first 5,000 characters" },
        Output { name: "stderr", kind: "text", doc: "warnings and hints, the first 2,000 characters" },
    ],
    example: r#"{"name": "churn"}"#,
};

impl Tool for RunScript {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        find(arguments, view).map(|_| Command::None)
    }

    fn task(&self, view: &View<'_>, arguments: &Arguments) -> Option<Task> {
        let (_, code) = find(arguments, view).ok()?;
        Some(Task::Run { code: code.to_owned(), seconds: LONGEST_SECONDS })
    }

    fn answer(&self, _: &View<'_>, _: &Arguments, _: &ResolvedCommand) -> Value {
        Value::Null
    }
}
