//! The context that tools read: texts, table documentation and the notebook.

use novamind_tools::{ColumnDocument, Notebook, Surroundings, TableDocument};
use novamind_world::events::Reading;

#[derive(Debug, Default)]
pub(crate) struct RunSurroundings {
    /// Calculations and scripts of the run.
    pub notebook: Notebook,
    /// Python must not be started, because the calls were decided elsewhere.
    pub keeps_python_out: bool,
}

impl Surroundings for RunSurroundings {
    fn describe(&self, reading: &Reading) -> String {
        novamind_voice::reading(reading)
    }

    fn tables(&self) -> Vec<TableDocument> {
        let document = |table: &'static novamind_database::Table| TableDocument {
            name: &table.name,
            description: &table.description,
            columns: table.columns.iter().map(document_of).collect(),
        };
        novamind_database::tables().iter().map(document).collect()
    }

    fn notebook(&self) -> &Notebook {
        &self.notebook
    }
}

fn document_of(column: &'static novamind_database::Column) -> ColumnDocument {
    ColumnDocument {
        name: &column.name,
        kind: &column.kind,
        values: &column.values,
        description: &column.description,
    }
}
