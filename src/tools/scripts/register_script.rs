use serde_json::{Value, json};

use super::super::arguments::{Arguments, text};
use super::super::{
    Argument, ArgumentKind, Kept, Kind, Module, Output, Refusal, Spec, Task, Tool, ToolId, View, When,
};
use crate::world::command::{Command, ResolvedCommand};

/// Stores a script.
pub struct RegisterScript;

static SPEC: Spec = Spec {
    id: ToolId::RegisterScript,
    code: "SCR",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Store a named script of SQL statements",
    arguments: &[
        Argument {
            name: "name",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            doc: "name of the script",
        },
        Argument {
            name: "code",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            doc: "read-only SQL statements, separated by ;",
        },
    ],
    own_unknown: false,
    whole: None,
    when: When::Now,
    effect: "run_script runs it. A script of the same name is replaced.",
    cost: "nothing",
    writes: &[],
    refusals: &["script_name_blank"],
    returns: &[
        Output { name: "name", kind: "text", doc: "the name, without the blanks around it" },
        Output { name: "code_length", kind: "integer", doc: "characters" },
    ],
    example: r#"{"name": "churn", "code": "SELECT status, COUNT(*) AS n FROM subscriptions GROUP BY 1"}"#,
};

impl Tool for RegisterScript {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        if text(arguments, "name")?.trim().is_empty() {
            return Err(Refusal::at("name", "script_name_blank", "the script needs a name"));
        }
        text(arguments, "code")?;
        Ok(Command::None)
    }

    fn task(&self, _: &View<'_>, arguments: &Arguments) -> Option<Task> {
        let (name, code) = (text(arguments, "name").ok()?.trim(), text(arguments, "code").ok()?);
        Some(Task::Keep { what: Kept::Script, name: name.to_owned(), code: code.to_owned() })
    }

    fn answer(&self, _: &View<'_>, arguments: &Arguments, _: &ResolvedCommand) -> Value {
        let name = text(arguments, "name").unwrap_or_default().trim();
        let code = text(arguments, "code").unwrap_or_default();
        json!({ "name": name, "code_length": code.chars().count() })
    }
}
