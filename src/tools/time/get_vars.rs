use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{
    EffectTiming, PlannedCall, Rejection, ResultField, Tool, ToolContext, ToolId, ToolKind, ToolModule,
    ToolSpec,
};

/// The tool `get_vars`, which returns the current day.
pub struct GetVars;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::GetVars,
    code: "VARS",
    module: ToolModule::Time,
    kind: ToolKind::Read,
    summary: "Show the current day",
    arguments: &[],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &[],
    result_fields: &[ResultField {
        name: "current_day",
        kind: "integer",
        description: "the last simulated day",
    }],
    example: "{}",
};

/// Variables that `get_vars` returns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Vars {
    /// Last simulated day; 0 before the first week.
    pub current_day: u32,
}

impl Tool for GetVars {
    type Args = ();
    type Answer = Vars;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, _: &Arguments) -> Result<(), Rejection> {
        Ok(())
    }

    fn plan(&self, view: &ToolContext<'_>, (): ()) -> Result<PlannedCall<Vars>, Rejection> {
        Ok(PlannedCall::read_only(Vars { current_day: view.day() }))
    }
}
