//! Stores and removes named code, for calculations and scripts.

use serde::Serialize;

use super::notebook::{NamedStatements, NotebookChange, NotebookSection};
use super::planned_call::PlannedCall;

/// A name and code in the arguments of a call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedCode {
    /// Name under which the code is stored.
    pub name: String,
    /// SQL statements or Python code.
    pub code: String,
}

/// The result of a call that stores code.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StoredCode {
    /// Name under which the code was stored.
    pub name: String,
    /// Length of the code in characters.
    pub code_length: usize,
}

impl NamedCode {
    /// Returns the planned call that stores the code in a section of the notebook.
    pub(super) fn planned_store(self, what: NotebookSection) -> PlannedCall<StoredCode> {
        let NamedCode { name, code } = self;
        let answer = StoredCode { name: name.clone(), code_length: code.chars().count() };
        PlannedCall::with_notebook_change(NotebookChange::Store { section: what, name, code }, answer)
    }
}

/// The result of a call that removes code.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RemainingNames {
    /// Name of the removed code.
    pub name: String,
    /// Names that remain in the section.
    pub remaining: Vec<String>,
}

impl RemainingNames {
    /// Returns the planned call that removes the code stored under a name.
    pub(super) fn planned_removal(
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
