//! Data of the session that tools read: descriptions of the economy, documentation of the tables, and the notebook.
//!
//! The session provides them, so that this crate needs neither the voice nor the database.

use super::notebook::Notebook;
use novamind_world::events::Reading;

/// Data of a session for tools.
pub trait SessionContext: Sync {
    /// Returns the description of a reading of the economy.
    fn describe_economy(&self, reading: &Reading) -> String;

    /// Returns the tables that can be queried, with their columns.
    fn tables(&self) -> Vec<TableDocument>;

    /// Returns the calculations and scripts of the run.
    fn notebook(&self) -> &Notebook;
}

/// Documentation of a visible table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableDocument {
    /// Name.
    pub name: &'static str,
    /// Description of the rows.
    pub description: &'static str,
    /// Columns.
    pub columns: Vec<ColumnDocument>,
}

/// Documentation of a visible column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnDocument {
    /// Name.
    pub name: &'static str,
    /// Declared type.
    pub kind: &'static str,
    /// All possible values, if they are few.
    pub values: &'static [String],
    /// Description.
    pub description: &'static str,
}

impl ColumnDocument {
    /// Returns type, values and meaning in one line: `TEXT, one of 'open', 'resolved': status`.
    pub fn format_line(&self) -> String {
        let values: Vec<String> = self.values.iter().map(|value| format!("'{value}'")).collect();
        let values =
            if values.is_empty() { String::new() } else { format!(", one of {}", values.join(", ")) };
        format!("{}{values}: {}", self.kind, self.description)
    }
}

/// Empty data: no descriptions, no tables, an empty notebook.
pub struct EmptyContext;

static EMPTY_NOTEBOOK: Notebook = Notebook::new();

impl SessionContext for EmptyContext {
    fn describe_economy(&self, _: &Reading) -> String {
        String::new()
    }

    fn tables(&self) -> Vec<TableDocument> {
        Vec::new()
    }

    fn notebook(&self) -> &Notebook {
        &EMPTY_NOTEBOOK
    }
}
