use serde_json::Value;

use super::super::arguments::{Arguments, number, text, wrong_type};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Range, Refusal, Spec, Task, Tool, ToolId, View, When,
};
use super::LONGEST_SECONDS;
use crate::world::command::{Command, ResolvedCommand};

/// Runs statements at once.
pub struct PythonExec;

static SPEC: Spec = Spec {
    id: ToolId::PythonExec,
    code: "PYX",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Run SQL statements over the visible tables; named after the tool with which agents run Python",
    arguments: &[
        Argument {
            name: "code",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            doc: "read-only SQL statements, separated by ;",
        },
        Argument {
            name: "timeout_seconds",
            alias: None,
            kind: ArgumentKind::Number(Range { above: true, ..Range::between(0.0, LONGEST_SECONDS) }),
            required: false,
            unit: "s",
            doc: "time for all statements together; 600 if left out",
        },
    ],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &["script_failed", "script_timeout"],
    returns: &[
        Output { name: "returncode", kind: "integer", doc: "0: every statement was answered" },
        Output { name: "stdout", kind: "text", doc: "the results as tables, the first 5,000 characters" },
        Output { name: "stderr", kind: "text", doc: "warnings and hints, the first 2,000 characters" },
    ],
    example: r#"{"code": "SELECT COUNT(*) AS n FROM customers"}"#,
};

fn seconds(arguments: &Arguments) -> Result<f64, Refusal> {
    let Some(given) = arguments.get("timeout_seconds") else { return Ok(LONGEST_SECONDS) };
    number(given)
        .filter(|seconds| *seconds > 0.0 && *seconds <= LONGEST_SECONDS)
        .ok_or_else(|| wrong_type("timeout_seconds", &format!("a number above 0, at most {LONGEST_SECONDS}")))
}

impl Tool for PythonExec {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        text(arguments, "code")?;
        seconds(arguments)?;
        Ok(Command::None)
    }

    fn task(&self, _: &View<'_>, arguments: &Arguments) -> Option<Task> {
        let code = text(arguments, "code").ok()?.to_owned();
        Some(Task::Run { code, seconds: seconds(arguments).ok()? })
    }

    fn answer(&self, _: &View<'_>, _: &Arguments, _: &ResolvedCommand) -> Value {
        Value::Null
    }
}
