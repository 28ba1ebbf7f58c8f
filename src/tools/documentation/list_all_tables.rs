use indexmap::IndexMap;
use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When};

/// The tool `list_all_tables`.
pub struct ListAllTables;

static SPEC: Spec = Spec {
    id: ToolId::ListAllTables,
    code: "TABS",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "List the tables that can be queried, one line each",
    arguments: &[],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &[],
    returns: &[
        Output { name: "tables", kind: "map table -> text", doc: "description of the rows" },
        Output { name: "count", kind: "integer", doc: "number of tables, 19" },
    ],
    example: r#"{}"#,
};

/// Tables that can be queried.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TableList {
    /// Number of tables.
    pub count: usize,
    /// Descriptions of the rows, by table name.
    pub tables: IndexMap<&'static str, &'static str>,
}

impl Tool for ListAllTables {
    type Args = ();
    type Answer = TableList;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, _: &Arguments) -> Result<(), Refusal> {
        Ok(())
    }

    fn plan(&self, view: &View<'_>, (): ()) -> Result<Planned<TableList>, Refusal> {
        let tables = view.surroundings().tables();
        let tables: IndexMap<_, _> = tables.iter().map(|table| (table.name, table.description)).collect();
        Ok(Planned::reading(TableList { count: tables.len(), tables }))
    }
}
