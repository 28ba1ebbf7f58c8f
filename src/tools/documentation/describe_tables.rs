use serde_json::{Map, Value, json};

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Refusal, Spec, TableDocument, Tool, ToolId, View, When,
};
use super::chosen;
use crate::world::command::{Command, ResolvedCommand};

/// Describes tables.
pub struct DescribeTables;

static SPEC: Spec = Spec {
    id: ToolId::DescribeTables,
    code: "DESC",
    module: Module::Time,
    kind: Kind::Engine,
    summary: "Describe tables with their columns",
    arguments: &[Argument {
        name: "table_names",
        alias: None,
        kind: ArgumentKind::Structure("a name, a list of names, or all"),
        required: false,
        unit: "",
        doc: "names of tables; all of them if left out",
    }],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &["table_not_found"],
    returns: &[Output {
        name: "tables",
        kind: "map table -> {description, columns}",
        doc: "what its rows are; columns maps each name to its type, its values where they are few, and its meaning",
    }],
    example: r#"{"table_names": "predictions"}"#,
};

impl Tool for DescribeTables {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let known: Vec<&str> = view.surroundings().tables().iter().map(|table| table.name).collect();
        chosen(arguments, "table_names", &known, "table_not_found").map(|_| Command::None)
    }

    fn answer(&self, view: &View<'_>, arguments: &Arguments, _: &ResolvedCommand) -> Value {
        let tables = view.surroundings().tables();
        let known: Vec<&str> = tables.iter().map(|table| table.name).collect();
        let names = chosen(arguments, "table_names", &known, "table_not_found").unwrap_or_default();
        let entry = |table: &TableDocument| {
            let columns: Map<String, Value> =
                table.columns.iter().map(|own| (own.name.to_owned(), own.line().into())).collect();
            (table.name.to_owned(), json!({ "description": table.description, "columns": columns }))
        };
        let described = tables.iter().filter(|table| names.contains(&table.name)).map(entry);
        json!({ "tables": described.collect::<Map<String, Value>>() })
    }
}
