use super::super::arguments::Arguments;
use super::super::stored_code::RemainingNames;
use super::super::{
    Argument, ArgumentKind, EffectTiming, NotebookSection, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::{find_script, script_name, stored_scripts};

/// The tool `delete_script`, which deletes a stored script.
pub struct DeleteScript;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::DeleteScript,
    code: "DELS",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "Delete a stored script",
    arguments: &[Argument {
        name: "name",
        alias: None,
        kind: ArgumentKind::Text,
        required: true,
        unit: "",
        description: "name of the script",
    }],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Now,
    effect: "The script is deleted.",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &["script_not_found"],
    result_fields: &[
        ResultField { name: "name", kind: "text", description: "the name" },
        ResultField { name: "remaining", kind: "list of text", description: "remaining names" },
    ],
    example: r#"{"name": "churn"}"#,
};

impl Tool for DeleteScript {
    type Args = String;
    type Answer = RemainingNames;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<String, Rejection> {
        script_name(arguments)
    }

    fn plan(&self, view: &ToolContext<'_>, name: String) -> Result<PlannedCall<RemainingNames>, Rejection> {
        find_script(&name, view)?;
        Ok(RemainingNames::planned_removal(stored_scripts(view), NotebookSection::Script, name))
    }
}
