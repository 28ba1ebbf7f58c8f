use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::stored_code::to_owned_names;
use super::super::{
    EffectTiming, PlannedCall, Rejection, ResultField, Tool, ToolContext, ToolId, ToolKind, ToolModule,
    ToolSpec,
};
use super::calculations;

/// The tool `list_daily_calculations`, which returns the names of the registered calculations.
pub struct ListDailyCalculations;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::ListDailyCalculations,
    code: "CALCS",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "List the names of the registered calculations",
    arguments: &[],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &[],
    result_fields: &[ResultField {
        name: "calculations",
        kind: "list of text",
        description: "names in the order in which they were registered",
    }],
    example: r#"{}"#,
};

/// Names of the registered calculations.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Calculations {
    /// Names in the order in which they were registered.
    pub calculations: Vec<String>,
}

impl Tool for ListDailyCalculations {
    type Args = ();
    type Answer = Calculations;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, _: &Arguments) -> Result<(), Rejection> {
        Ok(())
    }

    fn plan(&self, view: &ToolContext<'_>, (): ()) -> Result<PlannedCall<Calculations>, Rejection> {
        Ok(PlannedCall::read_only(Calculations { calculations: to_owned_names(calculations(view).names()) }))
    }
}
