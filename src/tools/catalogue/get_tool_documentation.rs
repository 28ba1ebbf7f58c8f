use indexmap::IndexMap;

use super::super::arguments::Arguments;
use super::super::describe::{ToolDocument, document_tool};
use super::super::documentation::NameSelection;
use super::super::{
    Argument, ArgumentKind, EffectTiming, ParameterNumbers, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::CATALOGUE;

/// The tool `get_tool_documentation`, which returns the documentation of tools.
pub struct GetToolDocumentation;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::GetToolDocumentation,
    code: "DOC",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "Show the documentation of tools: arguments, effect, cost, rejections, results",
    arguments: &[Argument {
        name: "tool_names",
        alias: None,
        kind: ArgumentKind::Structure("a name, a list of names, or all"),
        required: false,
        unit: "",
        description: "names of tools; all if left out",
    }],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &["tool_not_found"],
    result_fields: &[ResultField {
        name: "<tool>",
        kind: "object",
        description: "one field per tool with its documentation",
    }],
    example: r#"{"tool_names": "set_prices"}"#,
};

impl Tool for GetToolDocumentation {
    type Args = NameSelection;
    type Answer = IndexMap<&'static str, ToolDocument>;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(
        &self,
        _: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<NameSelection, Rejection> {
        NameSelection::parse(arguments, "tool_names")
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        name_selection: NameSelection,
    ) -> Result<PlannedCall<IndexMap<&'static str, ToolDocument>>, Rejection> {
        let known: Vec<&str> = CATALOGUE.iter().map(|tool| tool.spec().name()).collect();
        let names = name_selection.resolve_names(&known, "tool_names", "tool_not_found")?;
        let specs = CATALOGUE.iter().map(|tool| tool.spec()).filter(|spec| names.contains(&spec.name()));
        let numbers = ParameterNumbers::from_params(view.params());
        Ok(PlannedCall::read_only(specs.map(|spec| (spec.name(), document_tool(spec, &numbers))).collect()))
    }
}
