use indexmap::IndexMap;

use super::super::arguments::Arguments;
use super::super::describe::{ToolDocument, document};
use super::super::documentation::Choice;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Numbers, Output, Planned, Refusal, Spec, Tool, ToolId, View, When,
};
use super::CATALOGUE;

/// The tool `get_tool_documentation`.
pub struct GetToolDocumentation;

static SPEC: Spec = Spec {
    id: ToolId::GetToolDocumentation,
    code: "DOC",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Show the documentation of tools: arguments, effect, cost, rejections, results",
    arguments: &[Argument {
        name: "tool_names",
        alias: None,
        kind: ArgumentKind::Structure("a name, a list of names, or all"),
        required: false,
        unit: "",
        doc: "names of tools; all if left out",
    }],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &["tool_not_found"],
    returns: &[Output { name: "<tool>", kind: "object", doc: "one field per tool with its documentation" }],
    example: r#"{"tool_names": "set_prices"}"#,
};

impl Tool for GetToolDocumentation {
    type Args = Choice;
    type Answer = IndexMap<&'static str, ToolDocument>;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<Choice, Refusal> {
        Choice::read(arguments, "tool_names")
    }

    fn plan(
        &self,
        view: &View<'_>,
        asked: Choice,
    ) -> Result<Planned<IndexMap<&'static str, ToolDocument>>, Refusal> {
        let known: Vec<&str> = CATALOGUE.iter().map(|tool| tool.spec().name()).collect();
        let names = asked.among(&known, "tool_names", "tool_not_found")?;
        let specs = CATALOGUE.iter().map(|tool| tool.spec()).filter(|spec| names.contains(&spec.name()));
        let numbers = Numbers::of(view.params());
        Ok(Planned::reading(specs.map(|spec| (spec.name(), document(spec, &numbers))).collect()))
    }
}
