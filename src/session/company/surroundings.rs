//! What tools find around the company: words, the documents of the tables, and what is kept with the run.

use novamind_tools::{ColumnDocument, Notebook, Surroundings, TableDocument};
use novamind_world::events::Reading;

/// What a session has around its company.
#[derive(Debug, Default)]
pub(crate) struct RunSurroundings {
    /// Calculations and scripts.
    pub notebook: Notebook,
    /// Nobody plays: what is called was decided elsewhere, and starts no programs.
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
