use indexmap::IndexMap;
use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Refusal, Spec, TableDocument, Tool, ToolId, View,
    When,
};
use super::Choice;

/// The tool `describe_tables`.
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
        doc: "names of tables; all if left out",
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
        doc: "description of the rows; columns maps each name to its type, its values if they are few, and its meaning",
    }],
    example: r#"{"table_names": "predictions"}"#,
};

/// Tables by name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TableDescriptions {
    /// Requested tables.
    pub tables: IndexMap<&'static str, TableDescription>,
}

/// The description of a table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TableDescription {
    /// Description of the rows.
    pub description: &'static str,
    /// Type, values and meaning of each column.
    pub columns: IndexMap<&'static str, String>,
}

impl Tool for DescribeTables {
    type Args = Choice;
    type Answer = TableDescriptions;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<Choice, Refusal> {
        Choice::read(arguments, "table_names")
    }

    fn plan(&self, view: &View<'_>, asked: Choice) -> Result<Planned<TableDescriptions>, Refusal> {
        let tables = view.surroundings().tables();
        let known: Vec<&str> = tables.iter().map(|table| table.name).collect();
        let names = asked.among(&known, "table_names", "table_not_found")?;
        let entry = |table: &TableDocument| {
            let columns = table.columns.iter().map(|own| (own.name, own.line())).collect();
            (table.name, TableDescription { description: table.description, columns })
        };
        let tables = tables.iter().filter(|table| names.contains(&table.name)).map(entry).collect();
        Ok(Planned::reading(TableDescriptions { tables }))
    }
}
