//! Storing and removing named statements, for calculations and scripts.

use serde::Serialize;

use super::notebook::{NamedStatements, NotebookChange, NotebookSection};
use super::planned_call::PlannedCall;

/// Statements with their name in a call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedCode {
    /// Name.
    pub name: String,
    /// Statements.
    pub code: String,
}

/// The result of storing statements.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StoredCode {
    /// Name.
    pub name: String,
    /// Characters of the code.
    pub code_length: usize,
}

impl NamedCode {
    /// Returns the call that stores the statements.
    pub(super) fn store(self, what: NotebookSection) -> PlannedCall<StoredCode> {
        let NamedCode { name, code } = self;
        let answer = StoredCode { name: name.clone(), code_length: code.chars().count() };
        PlannedCall::with_notebook_change(NotebookChange::Store { section: what, name, code }, answer)
    }
}

/// The result of removing statements.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RemainingNames {
    /// Removed name.
    pub name: String,
    /// Remaining names.
    pub remaining: Vec<String>,
}

impl RemainingNames {
    /// Returns the call that removes a name.
    pub(super) fn after_removal(
        statements: &NamedStatements,
        what: NotebookSection,
        name: String,
    ) -> PlannedCall<RemainingNames> {
        let answer =
            RemainingNames { name: name.clone(), remaining: to_owned_names(statements.names_without(&name)) };
        PlannedCall::with_notebook_change(NotebookChange::Remove { section: what, name }, answer)
    }
}

pub(super) fn to_owned_names(names: Vec<&str>) -> Vec<String> {
    names.into_iter().map(str::to_owned).collect()
}
