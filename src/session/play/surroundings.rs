//! What tools find around the company: words, the documents of the tables, and what is kept with the run.

use serde::{Deserialize, Serialize};

use crate::database;
use crate::tools::{ColumnDocument, Notebook, Surroundings, TableDocument};
use crate::voice;
use crate::world::events::Reading;

/// What a session has around its company.
#[derive(Debug, Default)]
pub(in crate::session) struct RunSurroundings {
    /// Calculations and scripts.
    pub notebook: Notebook,
    /// Nobody plays: what is called was decided elsewhere, and starts no programs.
    pub keeps_python_out: bool,
}

impl Surroundings for RunSurroundings {
    fn describe(&self, reading: &Reading) -> String {
        voice::reading(reading)
    }

    fn tables(&self) -> Vec<TableDocument> {
        let document = |table: &'static database::Table| TableDocument {
            name: &table.name,
            description: &table.description,
            columns: table.columns.iter().map(document_of).collect(),
        };
        database::tables().iter().map(document).collect()
    }

    fn notebook(&self) -> &Notebook {
        &self.notebook
    }
}

fn document_of(column: &'static database::Column) -> ColumnDocument {
    ColumnDocument {
        name: &column.name,
        kind: &column.kind,
        values: &column.values,
        description: &column.description,
    }
}

/// A calculation and what it said before the last week.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Calculated {
    /// Name.
    pub name: String,
    /// Output, cut to what the dashboard shows.
    pub output: String,
}
