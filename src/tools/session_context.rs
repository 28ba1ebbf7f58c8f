//! Session data that tools read: descriptions of the economy, documentation of the tables, and the notebook.
//!
//! The session provides this data through a trait, so that this crate needs neither the voice nor the database.

use super::notebook::Notebook;
use novamind_world::events::Reading;
use novamind_world::params::Interface;

/// An interface through which tools read data of the session.
pub trait SessionContext: Sync {
    /// Returns a description of a PMI reading in words.
    fn describe_economy(&self, reading: &Reading) -> String;

    /// Returns the tables that can be queried under a release, with their columns.
    fn tables(&self, interface: Interface) -> Vec<TableDocument>;

    /// Returns the calculations and scripts of the run.
    fn notebook(&self) -> &Notebook;
}

/// Documentation of a visible table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableDocument {
    /// Name of the table.
    pub name: &'static str,
    /// Description of what a row represents.
    pub description: &'static str,
    /// Documentation of the table's columns.
    pub columns: Vec<ColumnDocument>,
}

/// Documentation of a visible column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnDocument {
    /// Name of the column.
    pub name: &'static str,
    /// Declared type of the column.
    pub kind: &'static str,
    /// All possible values of the column if there are few; otherwise empty.
    pub values: &'static [String],
    /// Description of the column.
    pub description: &'static str,
}

impl ColumnDocument {
    /// Formats the type, the values and the description in one line: `TEXT, one of 'open', 'resolved': status`.
    pub fn format_line(&self) -> String {
        let values: Vec<String> = self.values.iter().map(|value| format!("'{value}'")).collect();
        let values =
            if values.is_empty() { String::new() } else { format!(", one of {}", values.join(", ")) };
        format!("{}{values}: {}", self.kind, self.description)
    }
}

/// A session context without descriptions and tables, and with an empty notebook.
pub struct EmptyContext;

static EMPTY_NOTEBOOK: Notebook = Notebook::new();

impl SessionContext for EmptyContext {
    fn describe_economy(&self, _: &Reading) -> String {
        String::new()
    }

    fn tables(&self, _: Interface) -> Vec<TableDocument> {
        Vec::new()
    }

    fn notebook(&self) -> &Notebook {
        &EMPTY_NOTEBOOK
    }
}
