use super::super::arguments::{Arguments, text};
use super::super::keeping::{KeptCode, NamedCode};
use super::super::notebook::QUOTA_EXCEEDED;
use super::super::scripts::CODE;
use super::super::{
    Argument, ArgumentKind, Kept, Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When,
};

/// The tool `register_daily_calculation`.
pub struct RegisterDailyCalculation;

static SPEC: Spec = Spec {
    id: ToolId::RegisterDailyCalculation,
    code: "CALC",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Register a named calculation: it runs before every week, and the dashboard shows its output",
    arguments: &[
        Argument {
            name: "name",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            doc: "name of the calculation",
        },
        Argument { name: "code", alias: None, kind: ArgumentKind::Text, required: true, unit: "", doc: CODE },
    ],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "From the next week on, the code runs before each week, on the state of the company at that time. The \
             dashboard shows the first {limits.dashboard_calculation_max_chars} characters of the output. A calculation of the same name is \
             replaced. At most 100 calculations are stored, each with a name of at \
             most 200 bytes and at most 262,144 bytes of code. Scripts and calculations together have at most 4,194,304 bytes.",
    cost: "nothing",
    writes: &[],
    refusals: &[QUOTA_EXCEEDED],
    returns: &[
        Output { name: "name", kind: "text", doc: "the name" },
        Output { name: "code_length", kind: "integer", doc: "characters" },
    ],
    example: r#"{"name": "cash", "code": "SELECT SUM(amount) AS cash FROM ledger"}"#,
};

impl Tool for RegisterDailyCalculation {
    type Args = NamedCode;
    type Answer = KeptCode;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<NamedCode, Refusal> {
        Ok(NamedCode { name: text(arguments, "name")?.to_owned(), code: text(arguments, "code")?.to_owned() })
    }

    fn plan(&self, _: &View<'_>, given: NamedCode) -> Result<Planned<KeptCode>, Refusal> {
        Ok(given.keep(Kept::Calculation))
    }
}
