use indexmap::IndexMap;
use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{
    EffectTiming, PlannedCall, Rejection, ResultField, Tool, ToolContext, ToolId, ToolKind, ToolModule,
    ToolSpec,
};

/// The tool `list_all_tables`, which returns the tables that can be queried.
pub struct ListAllTables;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::ListAllTables,
    code: "TABS",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "List the tables that can be queried, one line each",
    arguments: &[],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &[],
    result_fields: &[
        ResultField { name: "tables", kind: "map table -> text", description: "description of the rows" },
        ResultField { name: "count", kind: "integer", description: "number of tables, 19" },
    ],
    example: r#"{}"#,
};

/// A list of the tables that can be queried.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TableList {
    /// Number of tables that can be queried.
    pub count: usize,
    /// Descriptions of the rows, by table name.
    pub tables: IndexMap<&'static str, &'static str>,
}

impl Tool for ListAllTables {
    type Args = ();
    type Answer = TableList;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, _: &Arguments) -> Result<(), Rejection> {
        Ok(())
    }

    fn plan(&self, view: &ToolContext<'_>, (): ()) -> Result<PlannedCall<TableList>, Rejection> {
        let tables = view.session().tables(view.params().fidelity.interface);
        let tables: IndexMap<_, _> = tables.iter().map(|table| (table.name, table.description)).collect();
        Ok(PlannedCall::read_only(TableList { count: tables.len(), tables }))
    }
}
