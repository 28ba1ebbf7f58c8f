//! Storing and removing named statements, for calculations and scripts.

use serde::Serialize;

use super::notebook::{Kept, NamedStatements, NotebookChange};
use super::planned::Planned;

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
pub struct KeptCode {
    /// Name.
    pub name: String,
    /// Characters of the code.
    pub code_length: usize,
}

impl NamedCode {
    /// Returns the call that stores the statements.
    pub(super) fn keep(self, what: Kept) -> Planned<KeptCode> {
        let NamedCode { name, code } = self;
        let answer = KeptCode { name: name.clone(), code_length: code.chars().count() };
        Planned::keeping(NotebookChange::Keep { what, name, code }, answer)
    }
}

/// The result of removing statements.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Remaining {
    /// Removed name.
    pub name: String,
    /// Remaining names.
    pub remaining: Vec<String>,
}

impl Remaining {
    /// Returns the call that removes a name.
    pub(super) fn without(statements: &NamedStatements, what: Kept, name: String) -> Planned<Remaining> {
        let answer = Remaining { name: name.clone(), remaining: owned(statements.names_without(&name)) };
        Planned::keeping(NotebookChange::Forget { what, name }, answer)
    }
}

pub(super) fn owned(names: Vec<&str>) -> Vec<String> {
    names.into_iter().map(str::to_owned).collect()
}
