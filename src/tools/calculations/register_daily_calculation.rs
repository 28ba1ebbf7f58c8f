use super::super::arguments::{Arguments, text_argument};
use super::super::notebook::QUOTA_EXCEEDED;
use super::super::scripts::CODE_DESCRIPTION;
use super::super::stored_code::{NamedCode, StoredCode};
use super::super::{
    Argument, ArgumentKind, EffectTiming, NotebookSection, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};

/// The tool `register_daily_calculation`, which stores a calculation that runs before every week.
pub struct RegisterDailyCalculation;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::RegisterDailyCalculation,
    code: "CALC",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "Register a named calculation: it runs before every week, and the dashboard shows its output",
    arguments: &[
        Argument {
            name: "name",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            description: "name of the calculation",
        },
        Argument {
            name: "code",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            description: CODE_DESCRIPTION,
        },
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::NextDay,
    effect: "From the next week on, the code runs before each week, on the state of the company at that time. The \
             dashboard shows the first {limits.dashboard_calculation_max_chars} characters of the output. A calculation of the same name is \
             replaced. At most 100 calculations are stored, each with a name of at \
             most 200 bytes and at most 262,144 bytes of code. Scripts and calculations together have at most 4,194,304 bytes.",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &[QUOTA_EXCEEDED],
    result_fields: &[
        ResultField { name: "name", kind: "text", description: "the name" },
        ResultField { name: "code_length", kind: "integer", description: "characters" },
    ],
    example: r#"{"name": "cash", "code": "SELECT SUM(amount) AS cash FROM ledger"}"#,
};

impl Tool for RegisterDailyCalculation {
    type Args = NamedCode;
    type Answer = StoredCode;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<NamedCode, Rejection> {
        Ok(NamedCode {
            name: text_argument(arguments, "name")?.to_owned(),
            code: text_argument(arguments, "code")?.to_owned(),
        })
    }

    fn plan(&self, _: &ToolContext<'_>, named_code: NamedCode) -> Result<PlannedCall<StoredCode>, Rejection> {
        Ok(named_code.planned_store(NotebookSection::Calculation))
    }
}
