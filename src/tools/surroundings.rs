//! What a tool may look at besides the company: words, the documents of the tables, what is kept with the run.
//!
//! The session brings them, for neither the words nor the database are a tool's business.

use super::notebook::Notebook;
use novamind_world::events::Reading;

/// The surroundings of a company.
pub trait Surroundings: Sync {
    /// Words for a reading of the economy.
    fn describe(&self, reading: &Reading) -> String;

    /// The tables that can be asked, with their columns.
    fn tables(&self) -> Vec<TableDocument>;

    /// Calculations and scripts of the run.
    fn notebook(&self) -> &Notebook;
}

/// A visible table, as documentation tells of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableDocument {
    /// Name.
    pub name: &'static str,
    /// What its rows are.
    pub description: &'static str,
    /// Its columns.
    pub columns: Vec<ColumnDocument>,
}

/// A visible column, as documentation tells of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnDocument {
    /// Name.
    pub name: &'static str,
    /// Declared type.
    pub kind: &'static str,
    /// All values it can have, where that is a short list.
    pub values: &'static [String],
    /// What it holds.
    pub description: &'static str,
}

impl ColumnDocument {
    /// Type, values and meaning in a line: `TEXT, one of 'open', 'resolved': how it stands`.
    pub fn line(&self) -> String {
        let values: Vec<String> = self.values.iter().map(|value| format!("'{value}'")).collect();
        let values =
            if values.is_empty() { String::new() } else { format!(", one of {}", values.join(", ")) };
        format!("{}{values}: {}", self.kind, self.description)
    }
}

/// A company alone: no words, no tables, nothing kept.
pub struct Nothing;

static EMPTY: Notebook = Notebook::new();

impl Surroundings for Nothing {
    fn describe(&self, _: &Reading) -> String {
        String::new()
    }

    fn tables(&self) -> Vec<TableDocument> {
        Vec::new()
    }

    fn notebook(&self) -> &Notebook {
        &EMPTY
    }
}
