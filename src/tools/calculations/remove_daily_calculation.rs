use super::super::arguments::{Arguments, text_argument};
use super::super::stored_code::RemainingNames;
use super::super::{
    Argument, ArgumentKind, EffectTiming, NotebookSection, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::{calculations, not_found_rejection};

/// The tool `remove_daily_calculation`, which removes a stored calculation.
pub struct RemoveDailyCalculation;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::RemoveDailyCalculation,
    code: "UNCAL",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "Remove a named calculation",
    arguments: &[Argument {
        name: "name",
        alias: None,
        kind: ArgumentKind::Text,
        required: true,
        unit: "",
        description: "name of the calculation",
    }],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Now,
    effect: "The calculation no longer runs.",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &["calculation_not_found"],
    result_fields: &[
        ResultField { name: "name", kind: "text", description: "the name" },
        ResultField { name: "remaining", kind: "list of text", description: "remaining names" },
    ],
    example: r#"{"name": "cash"}"#,
};

impl Tool for RemoveDailyCalculation {
    type Args = String;
    type Answer = RemainingNames;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<String, Rejection> {
        text_argument(arguments, "name").map(str::to_owned)
    }

    fn plan(&self, view: &ToolContext<'_>, name: String) -> Result<PlannedCall<RemainingNames>, Rejection> {
        match calculations(view).get(&name) {
            Some(_) => {
                Ok(RemainingNames::planned_removal(calculations(view), NotebookSection::Calculation, name))
            }
            None => Err(not_found_rejection(&name, view)),
        }
    }
}
