use super::super::arguments::{Arguments, text_argument};
use super::super::{
    Argument, ArgumentKind, EffectTiming, PlannedCall, Rejection, ResultField, Tool, ToolContext, ToolId,
    ToolKind, ToolModule, ToolSpec,
};

/// The tool `query`, which runs one SQL statement. The session implements the tool; `Query` documents the tool and
/// checks its argument.
pub struct Query;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::Query,
    code: "QRY",
    module: ToolModule::Time,
    kind: ToolKind::Read,
    summary: "Query the company's database with one read-only SQL statement",
    arguments: &[Argument {
        name: "sql",
        alias: None,
        kind: ArgumentKind::Text,
        required: false,
        unit: "",
        description: "one SELECT statement over the 19 visible tables",
    }],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &[
        "sql_empty",
        "sql_schema",
        "sql_hidden_table",
        "sql_write",
        "sql_timeout",
        "sql_cancelled",
        "sql_error",
    ],
    result_fields: &[
        ResultField { name: "columns", kind: "list of text", description: "names of the columns" },
        ResultField {
            name: "rows",
            kind: "list of objects",
            description: "at most {limits.query_row_limit:,}",
        },
        ResultField { name: "row_count", kind: "integer", description: "number of rows" },
        ResultField {
            name: "truncated",
            kind: "boolean",
            description: "whether more rows exist; if so, there is also a warning",
        },
        ResultField { name: "hint", kind: "text", description: "why an empty result may be empty" },
    ],
    example: r#"{"sql": "SELECT SUM(amount) AS cash FROM ledger"}"#,
};

impl Tool for Query {
    type Args = ();
    type Answer = ();

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<(), Rejection> {
        text_argument(arguments, "sql").map(|_| ())
    }

    fn plan(&self, _: &ToolContext<'_>, (): ()) -> Result<PlannedCall<()>, Rejection> {
        Ok(PlannedCall::read_only(()))
    }
}
