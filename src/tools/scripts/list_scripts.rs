use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::stored_code::to_owned_names;
use super::super::{
    EffectTiming, PlannedCall, Rejection, ResultField, Tool, ToolContext, ToolId, ToolKind, ToolModule,
    ToolSpec,
};
use super::stored_scripts;

/// The tool `list_scripts`, which returns the names of the stored scripts.
pub struct ListScripts;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::ListScripts,
    code: "SCRS",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "List the names of the stored scripts",
    arguments: &[],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &[],
    result_fields: &[ResultField {
        name: "scripts",
        kind: "list of text",
        description: "names in the order in which they were stored",
    }],
    example: r#"{}"#,
};

/// Names of the stored scripts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Scripts {
    /// Names in the order in which they were stored.
    pub scripts: Vec<String>,
}

impl Tool for ListScripts {
    type Args = ();
    type Answer = Scripts;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, _: &Arguments) -> Result<(), Rejection> {
        Ok(())
    }

    fn plan(&self, view: &ToolContext<'_>, (): ()) -> Result<PlannedCall<Scripts>, Rejection> {
        Ok(PlannedCall::read_only(Scripts { scripts: to_owned_names(stored_scripts(view).names()) }))
    }
}
