//! The notebook of a run: named calculations for the dashboard, and scripts.
//!
//! Both are SQL statements or Python. They never affect the simulation.

use serde::{Deserialize, Serialize};

use super::refusal::Refusal;
use novamind_base::notation::grouped;

/// Maximum number of scripts of a run, and of calculations.
const MAX_ENTRIES: usize = 100;
const MAX_CODE_BYTES: usize = 256 * 1024;
const MAX_NAME_BYTES: usize = 200;
/// Maximum bytes of all scripts and calculations of a run together.
const MAX_BYTES: usize = 4 * 1024 * 1024;

/// Rejection code of entries beyond a quota.
pub(super) const QUOTA_EXCEEDED: &str = "quota_exceeded";

/// Section of the notebook.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// Code that runs before every week, with its output on the dashboard.
    Calculation,
    /// Code that runs on request.
    Script,
}

/// A change of the notebook.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotebookChange {
    /// Store statements under a name.
    Keep {
        /// Section.
        what: Kept,
        /// Name.
        name: String,
        /// Statements.
        code: String,
    },
    /// Remove a name.
    Forget {
        /// Section.
        what: Kept,
        /// Name.
        name: String,
    },
}

/// Named statements in the order in which their names were first stored.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct NamedStatements(Vec<(String, String)>);

impl NamedStatements {
    /// Returns the statements of a name.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(own, _)| own == name).map(|(_, code)| code.as_str())
    }

    /// Returns all names.
    pub fn names(&self) -> Vec<&str> {
        self.0.iter().map(|(name, _)| name.as_str()).collect()
    }

    /// Returns all names except one.
    pub fn names_without(&self, name: &str) -> Vec<&str> {
        self.names().into_iter().filter(|own| *own != name).collect()
    }

    /// Returns names and statements.
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
    /// Returns an empty notebook.
    pub const fn new() -> Notebook {
        Notebook { calculations: NamedStatements(Vec::new()), scripts: NamedStatements(Vec::new()) }
    }

    /// Returns the statements of a section.
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

    /// Rejects a change beyond the quotas. A session checks new calls only; recorded calls of older versions are applied at any
    /// size.
    ///
    /// # Errors
    /// `quota_exceeded`, with the limit.
    pub fn refuse_beyond_quota(&self, change: &NotebookChange) -> Result<(), Refusal> {
        let NotebookChange::Keep { what, name, code } = change else { return Ok(()) };
        let refused = |field: &str, message: String| {
            let message = format!("{message}; nothing was stored and nothing was removed");
            Err(Refusal::at(field, QUOTA_EXCEEDED, message))
        };
        let bytes = |count: usize| grouped(count as f64, 0);
        if name.len() > MAX_NAME_BYTES {
            return refused(
                "name",
                format!("the name has {} bytes, and {MAX_NAME_BYTES} are allowed", bytes(name.len())),
            );
        }
        if code.len() > MAX_CODE_BYTES {
            let (own, most) = (bytes(code.len()), bytes(MAX_CODE_BYTES));
            return refused("code", format!("the code has {own} bytes, and {most} are allowed"));
        }
        let own = self.statements(*what);
        if own.get(name).is_none() && own.entries().len() >= MAX_ENTRIES {
            let kind = match what {
                Kept::Calculation => "calculations",
                Kept::Script => "scripts",
            };
            return refused(
                "name",
                format!("the run keeps {MAX_ENTRIES} {kind}, and no more are allowed; delete one first"),
            );
        }
        let entries = self.calculations.entries().iter().chain(self.scripts.entries());
        let kept: usize = entries.map(|(name, code)| name.len() + code.len()).sum();
        let replaced = own.get(name).map_or(0, |code| name.len() + code.len());
        let after = kept - replaced + name.len() + code.len();
        if after > MAX_BYTES {
            let (after, most) = (bytes(after), bytes(MAX_BYTES));
            let message = format!(
                "scripts and calculations would have {after} bytes together, and {most} are allowed; delete some first"
            );
            return refused("code", message);
        }
        Ok(())
    }

    /// Applies a change.
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
    use crate::ToolId;

    #[test]
    fn quotas_bound_names_codes_counts_and_the_whole() {
        let keep = |what: Kept, name: &str, bytes: usize| NotebookChange::Keep {
            what,
            name: name.to_owned(),
            code: "x".repeat(bytes),
        };
        let field = |notebook: &Notebook, change: &NotebookChange| {
            notebook.refuse_beyond_quota(change).err().map(|refusal| (refusal.code, refusal.field))
        };
        let beyond = |field: &str| Some((QUOTA_EXCEEDED, Some(field.to_owned())));
        let mut notebook = Notebook::new();
        assert_eq!(field(&notebook, &keep(Kept::Script, &"n".repeat(201), 1)), beyond("name"));
        assert_eq!(field(&notebook, &keep(Kept::Script, "a", MAX_CODE_BYTES + 1)), beyond("code"));
        assert_eq!(field(&notebook, &keep(Kept::Script, "a", MAX_CODE_BYTES)), None);
        for number in 0..MAX_ENTRIES {
            notebook.apply(&keep(Kept::Script, &format!("s{number}"), 1));
        }
        assert_eq!(field(&notebook, &keep(Kept::Script, "another", 1)), beyond("name"));
        assert_eq!(field(&notebook, &keep(Kept::Script, "s7", 2)), None, "it replaces one");
        assert_eq!(field(&notebook, &keep(Kept::Calculation, "another", 1)), None);
        for number in 0..15 {
            notebook.apply(&keep(Kept::Script, &format!("s{number}"), MAX_CODE_BYTES));
        }
        let room = MAX_BYTES - (15 * MAX_CODE_BYTES + 85 + 10 * 2 + 90 * 3);
        assert_eq!(field(&notebook, &keep(Kept::Calculation, "c", room - 1)), None);
        assert_eq!(field(&notebook, &keep(Kept::Calculation, "c", room)), beyond("code"));
        assert_eq!(field(&notebook, &keep(Kept::Script, "s0", MAX_CODE_BYTES)), None, "it replaces itself");
        for tool in [ToolId::RegisterScript, ToolId::RegisterDailyCalculation] {
            for quota in [MAX_ENTRIES, MAX_CODE_BYTES, MAX_NAME_BYTES, MAX_BYTES] {
                assert!(tool.spec().effect.contains(&grouped(quota as f64, 0)), "{tool}: {quota}");
            }
        }
    }

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
