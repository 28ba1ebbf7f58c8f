use serde_json::{Value, json};

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, Kept, Kind, Module, Output, Refusal, Spec, Task, Tool, ToolId, View, When,
};
use super::{find, stored};
use crate::world::command::{Command, ResolvedCommand};

/// Deletes a script.
pub struct DeleteScript;

static SPEC: Spec = Spec {
    id: ToolId::DeleteScript,
    code: "DELS",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Delete a stored script",
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
    when: When::Now,
    effect: "The script is gone.",
    cost: "nothing",
    writes: &[],
    refusals: &["script_not_found"],
    returns: &[
        Output { name: "name", kind: "text", doc: "the name" },
        Output { name: "remaining", kind: "list of text", doc: "remaining names" },
    ],
    example: r#"{"name": "churn"}"#,
};

impl Tool for DeleteScript {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        find(arguments, view).map(|_| Command::None)
    }

    fn task(&self, view: &View<'_>, arguments: &Arguments) -> Option<Task> {
        let (name, _) = find(arguments, view).ok()?;
        Some(Task::Forget { what: Kept::Script, name: name.to_owned() })
    }

    fn answer(&self, view: &View<'_>, arguments: &Arguments, _: &ResolvedCommand) -> Value {
        let Ok((name, _)) = find(arguments, view) else { return Value::Null };
        json!({ "name": name, "remaining": stored(view).names_without(name) })
    }
}
