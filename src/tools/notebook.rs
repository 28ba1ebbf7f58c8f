//! What a player keeps with a run: calculations for the dashboard, and scripts.
//!
//! Both are names for code: SQL statements, or Python. Nothing of it reaches the world.

use serde::{Deserialize, Serialize};

/// What is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// Run before every week; the output stands on the dashboard.
    Calculation,
    /// Run on request.
    Script,
}

/// What a call changes in the notebook.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotebookChange {
    /// Keep statements under a name.
    Keep {
        /// As what.
        what: Kept,
        /// Name.
        name: String,
        /// Statements.
        code: String,
    },
    /// Forget a name.
    Forget {
        /// What it was.
        what: Kept,
        /// Name.
        name: String,
    },
}

/// Named statements in the order in which their names were first kept.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct NamedStatements(Vec<(String, String)>);

impl NamedStatements {
    /// The statements of a name.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(own, _)| own == name).map(|(_, code)| code.as_str())
    }

    /// All names.
    pub fn names(&self) -> Vec<&str> {
        self.0.iter().map(|(name, _)| name.as_str()).collect()
    }

    /// All names but one.
    pub fn names_without(&self, name: &str) -> Vec<&str> {
        self.names().into_iter().filter(|own| *own != name).collect()
    }

    /// Names and statements.
    pub fn entries(&self) -> &[(String, String)] {
        &self.0
    }

    fn keep(&mut self, name: &str, code: &str) {
        match self.0.iter_mut().find(|(own, _)| own == name) {
            Some((_, old)) => code.clone_into(old),
            None => self.0.push((name.to_owned(), code.to_owned())),
        }
    }

    fn forget(&mut self, name: &str) {
        self.0.retain(|(own, _)| own != name);
    }
}

/// The calculations and scripts of a run.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Notebook {
    calculations: NamedStatements,
    scripts: NamedStatements,
}

impl Notebook {
    /// An empty one.
    pub const fn new() -> Notebook {
        Notebook { calculations: NamedStatements(Vec::new()), scripts: NamedStatements(Vec::new()) }
    }

    /// What is kept of a kind.
    pub fn statements(&self, what: Kept) -> &NamedStatements {
        match what {
            Kept::Calculation => &self.calculations,
            Kept::Script => &self.scripts,
        }
    }

    fn statements_mut(&mut self, what: Kept) -> &mut NamedStatements {
        match what {
            Kept::Calculation => &mut self.calculations,
            Kept::Script => &mut self.scripts,
        }
    }

    /// Keeps or forgets what a change says.
    pub fn apply(&mut self, change: &NotebookChange) {
        match change {
            NotebookChange::Keep { what, name, code } => self.statements_mut(*what).keep(name, code),
            NotebookChange::Forget { what, name } => self.statements_mut(*what).forget(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_their_place_when_their_statements_change() {
        let mut notebook = Notebook::new();
        let what = Kept::Calculation;
        let keep = |name: &str, code: &str| NotebookChange::Keep {
            what,
            name: name.to_owned(),
            code: code.to_owned(),
        };
        for change in [keep("a", "SELECT 1"), keep("b", "SELECT 2"), keep("a", "SELECT 3")] {
            notebook.apply(&change);
        }
        assert_eq!(notebook.statements(what).names(), ["a", "b"]);
        assert_eq!(notebook.statements(what).get("a"), Some("SELECT 3"));
        assert!(notebook.statements(Kept::Script).names().is_empty());
        notebook.apply(&NotebookChange::Forget { what, name: "a".to_owned() });
        assert_eq!(notebook.statements(what).entries(), [("b".to_owned(), "SELECT 2".to_owned())]);
    }
}
