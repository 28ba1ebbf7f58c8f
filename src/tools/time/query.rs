use super::super::arguments::{Arguments, text};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When,
};

/// The tool `query`. The session implements it; this entry documents it.
pub struct Query;

static SPEC: Spec = Spec {
    id: ToolId::Query,
    code: "QRY",
    module: Module::Time,
    kind: Kind::Read,
    summary: "Query the company's database with one read-only SQL statement",
    arguments: &[Argument {
        name: "sql",
        alias: None,
        kind: ArgumentKind::Text,
        required: false,
        unit: "",
        doc: "one SELECT statement over the 19 visible tables",
    }],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &[
        "sql_empty",
        "sql_schema",
        "sql_hidden_table",
        "sql_write",
        "sql_timeout",
        "sql_cancelled",
        "sql_error",
    ],
    returns: &[
        Output { name: "columns", kind: "list of text", doc: "names of the columns" },
        Output { name: "rows", kind: "list of objects", doc: "at most {limits.query_row_limit:,}" },
        Output { name: "row_count", kind: "integer", doc: "number of rows" },
        Output {
            name: "truncated",
            kind: "boolean",
            doc: "whether more rows exist; if so, there is also a warning",
        },
        Output { name: "hint", kind: "text", doc: "why an empty result may be empty" },
    ],
    example: r#"{"sql": "SELECT SUM(amount) AS cash FROM ledger"}"#,
};

impl Tool for Query {
    type Args = ();
    type Answer = ();

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<(), Refusal> {
        text(arguments, "sql").map(|_| ())
    }

    fn plan(&self, _: &View<'_>, (): ()) -> Result<Planned<()>, Refusal> {
        Ok(Planned::reading(()))
    }
}
