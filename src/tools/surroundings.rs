//! What a tool may look at besides the company: words, the documents of the tables, what is kept with the run.
//!
//! The session brings them, for neither the words nor the database are a tool's business.

use super::notebook::Notebook;
use crate::world::market::economy::Reading;

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
    /// Names of the columns and what they hold.
    pub columns: Vec<(&'static str, &'static str)>,
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
