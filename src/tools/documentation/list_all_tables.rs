use serde_json::{Map, Value, json};

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Refusal, Spec, Tool, ToolId, View, When};
use crate::world::command::{Command, ResolvedCommand};

/// Lists the tables.
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
        Output { name: "tables", kind: "map table -> text", doc: "what its rows are" },
        Output { name: "count", kind: "integer", doc: "number of tables, 19" },
    ],
    example: r#"{}"#,
};

impl Tool for ListAllTables {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, _: &Arguments) -> Result<Command, Refusal> {
        Ok(Command::None)
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, _: &ResolvedCommand) -> Value {
        let tables = view.surroundings().tables();
        let lines: Map<String, Value> =
            tables.iter().map(|table| (table.name.to_owned(), table.description.into())).collect();
        json!({ "count": lines.len(), "tables": lines })
    }
}
