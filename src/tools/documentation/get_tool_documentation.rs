use serde_json::Value;

use super::super::arguments::Arguments;
use super::super::describe::as_json;
use super::super::{
    Argument, ArgumentKind, CATALOGUE, Kind, Module, Numbers, Output, Refusal, Spec, Tool, ToolId, View, When,
};
use super::chosen;
use crate::world::command::{Command, ResolvedCommand};

/// Documents tools.
pub struct GetToolDocumentation;

static SPEC: Spec = Spec {
    id: ToolId::GetToolDocumentation,
    code: "DOC",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Show everything about tools: arguments, effect, cost, refusals, results",
    arguments: &[Argument {
        name: "tool_names",
        alias: None,
        kind: ArgumentKind::Structure("a name, a list of names, or all"),
        required: false,
        unit: "",
        doc: "names of tools; all of them if left out",
    }],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &["tool_not_found"],
    returns: &[Output { name: "<tool>", kind: "object", doc: "one field per tool: its documentation" }],
    example: r#"{"tool_names": "set_prices"}"#,
};

fn all_names() -> Vec<&'static str> {
    CATALOGUE.iter().map(|tool| tool.spec().name()).collect()
}

impl Tool for GetToolDocumentation {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        chosen(arguments, "tool_names", &all_names(), "tool_not_found").map(|_| Command::None)
    }

    fn answer(&self, view: &View<'_>, arguments: &Arguments, _: &ResolvedCommand) -> Value {
        let names = chosen(arguments, "tool_names", &all_names(), "tool_not_found").unwrap_or_default();
        let tools = CATALOGUE.iter().filter(|tool| names.contains(&tool.spec().name()));
        let numbers = Numbers::of(view.params());
        tools.map(|tool| (tool.spec().name().to_owned(), as_json(*tool, &numbers))).collect()
    }
}
