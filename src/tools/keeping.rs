//! Keeping statements under a name and forgetting them: what calculations and scripts share.

use serde::Serialize;

use super::notebook::{Kept, NamedStatements, NotebookChange};
use super::planned::Planned;

/// Statements and their name, as a call gives them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedCode {
    /// Name.
    pub name: String,
    /// Statements.
    pub code: String,
}

/// Statements that are kept now.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct KeptCode {
    /// Their name.
    pub name: String,
    /// Their characters.
    pub code_length: usize,
}

impl NamedCode {
    /// The call that keeps them.
    pub(super) fn keep(self, what: Kept) -> Planned<KeptCode> {
        let NamedCode { name, code } = self;
        let answer = KeptCode { name: name.clone(), code_length: code.chars().count() };
        Planned::keeping(NotebookChange::Keep { what, name, code }, answer)
    }
}

/// What is left after a name was forgotten.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Remaining {
    /// The name that was forgotten.
    pub name: String,
    /// The others.
    pub remaining: Vec<String>,
}

impl Remaining {
    /// The call that forgets a name.
    pub(super) fn without(statements: &NamedStatements, what: Kept, name: String) -> Planned<Remaining> {
        let answer = Remaining { name: name.clone(), remaining: owned(statements.names_without(&name)) };
        Planned::keeping(NotebookChange::Forget { what, name }, answer)
    }
}

/// Names that an answer takes with it.
pub(super) fn owned(names: Vec<&str>) -> Vec<String> {
    names.into_iter().map(str::to_owned).collect()
}
