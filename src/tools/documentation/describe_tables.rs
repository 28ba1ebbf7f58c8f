use indexmap::IndexMap;
use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, EffectTiming, PlannedCall, Rejection, ResultField, TableDocument, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use super::NameSelection;

/// The tool `describe_tables`, which returns the descriptions of tables and their columns.
pub struct DescribeTables;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::DescribeTables,
    code: "DESC",
    module: ToolModule::Time,
    kind: ToolKind::Engine,
    summary: "Describe tables with their columns",
    arguments: &[Argument {
        name: "table_names",
        alias: None,
        kind: ArgumentKind::Structure("a name, a list of names, or all"),
        required: false,
        unit: "",
        description: "names of tables; all if left out",
    }],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &["table_not_found"],
    result_fields: &[ResultField {
        name: "tables",
        kind: "map table -> {description, columns}",
        description: "description of the rows; columns maps each name to its type, its values if they are few, and its meaning",
    }],
    example: r#"{"table_names": "predictions"}"#,
};

/// Descriptions of tables, by name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TableDescriptions {
    /// Descriptions of the requested tables.
    pub tables: IndexMap<&'static str, TableDescription>,
}

/// The description of a table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TableDescription {
    /// Description of what a row of the table represents.
    pub description: &'static str,
    /// Type, values and meaning of each column.
    pub columns: IndexMap<&'static str, String>,
}

impl Tool for DescribeTables {
    type Args = NameSelection;
    type Answer = TableDescriptions;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(
        &self,
        _: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<NameSelection, Rejection> {
        NameSelection::parse(arguments, "table_names")
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        name_selection: NameSelection,
    ) -> Result<PlannedCall<TableDescriptions>, Rejection> {
        let tables = view.session().tables(view.params().fidelity.interface);
        let known: Vec<&str> = tables.iter().map(|table| table.name).collect();
        let names = name_selection.resolve_names(&known, "table_names", "table_not_found")?;
        let entry = |table: &TableDocument| {
            let columns = table
                .columns
                .iter()
                .map(|column_document| (column_document.name, column_document.format_line()))
                .collect();
            (table.name, TableDescription { description: table.description, columns })
        };
        let tables = tables.iter().filter(|table| names.contains(&table.name)).map(entry).collect();
        Ok(PlannedCall::read_only(TableDescriptions { tables }))
    }
}
