//! The context that tools read: texts, table documentation and notebook of a run.

use novamind_tools::{ColumnDocument, Notebook, SessionContext, TableDocument};
use novamind_world::events::Reading;
use novamind_world::params::Interface;

#[derive(Debug, Default)]
pub(crate) struct RunContext {
    /// Calculations and scripts of the run.
    pub notebook: Notebook,
    /// Whether Python code is not executed, because the calls repeat recorded decisions.
    pub is_python_disabled: bool,
}

impl SessionContext for RunContext {
    fn describe_economy(&self, reading: &Reading) -> String {
        novamind_voice::reading_text(reading)
    }

    fn tables(&self, interface: Interface) -> Vec<TableDocument> {
        let document = |table: &'static novamind_database::Table| TableDocument {
            name: &table.name,
            description: &table.description,
            columns: table.columns.iter().map(column_document).collect(),
        };
        novamind_database::tables(interface).iter().map(document).collect()
    }

    fn notebook(&self) -> &Notebook {
        &self.notebook
    }
}

fn column_document(column: &'static novamind_database::Column) -> ColumnDocument {
    ColumnDocument {
        name: &column.name,
        kind: &column.kind,
        values: &column.values,
        description: &column.description,
    }
}
