use serde_json::{Value, json};

use super::super::arguments::{Arguments, text};
use super::super::{
    Argument, ArgumentKind, Kept, Kind, Module, Output, Refusal, Spec, Task, Tool, ToolId, View, When,
};
use super::{kept, not_found};
use crate::world::command::{Command, ResolvedCommand};

/// Drops a calculation.
pub struct RemoveDailyCalculation;

static SPEC: Spec = Spec {
    id: ToolId::RemoveDailyCalculation,
    code: "UNCAL",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Remove a named calculation",
    arguments: &[Argument {
        name: "name",
        alias: None,
        kind: ArgumentKind::Text,
        required: true,
        unit: "",
        doc: "name of the calculation",
    }],
    own_unknown: false,
    whole: None,
    when: When::Now,
    effect: "The calculation no longer runs.",
    cost: "nothing",
    writes: &[],
    refusals: &["calculation_not_found"],
    returns: &[
        Output { name: "name", kind: "text", doc: "the name" },
        Output { name: "remaining", kind: "list of text", doc: "remaining names" },
    ],
    example: r#"{"name": "cash"}"#,
};

impl Tool for RemoveDailyCalculation {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let name = text(arguments, "name")?;
        match kept(view).get(name) {
            Some(_) => Ok(Command::None),
            None => Err(not_found(name, view)),
        }
    }

    fn task(&self, _: &View<'_>, arguments: &Arguments) -> Option<Task> {
        let name = text(arguments, "name").ok()?.to_owned();
        Some(Task::Forget { what: Kept::Calculation, name })
    }

    fn answer(&self, view: &View<'_>, arguments: &Arguments, _: &ResolvedCommand) -> Value {
        let name = text(arguments, "name").unwrap_or_default();
        json!({ "name": name, "remaining": kept(view).names_without(name) })
    }
}
