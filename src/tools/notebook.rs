//! The notebook of a run: named calculations for the dashboard, and scripts.
//!
//! Calculations and scripts are SQL statements or Python programs. Neither calculations nor scripts affect the
//! simulation.

use serde::{Deserialize, Serialize};

use super::rejection::Rejection;
use novamind_base::formatting::grouped_number;

/// Maximum number of scripts in a run. The same maximum applies separately to calculations.
const MAX_ENTRIES: usize = 100;
const MAX_CODE_BYTES: usize = 256 * 1024;
const MAX_NAME_BYTES: usize = 200;
/// Maximum total size of all scripts and calculations of a run, in bytes.
const MAX_BYTES: usize = 4 * 1024 * 1024;

/// Rejection code for a script or calculation that exceeds a quota.
pub(super) const QUOTA_EXCEEDED: &str = "quota_exceeded";

/// A section of the notebook.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NotebookSection {
    /// Code that runs before every week. The dashboard shows the output of the code.
    Calculation,
    /// Code that runs when the player calls it.
    Script,
}

/// A change to the notebook.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotebookChange {
    /// Stores code under a name.
    Store {
        /// Section that stores the code.
        section: NotebookSection,
        /// Name under which the code is stored.
        name: String,
        /// SQL statements or Python code.
        code: String,
    },
    /// Removes the code stored under a name.
    Remove {
        /// Section that contains the code.
        section: NotebookSection,
        /// Name of the code to remove.
        name: String,
    },
}

/// Named code, in the order in which the names were first stored.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct NamedStatements(Vec<(String, String)>);

impl NamedStatements {
    /// Returns the code stored under a name.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(text, _)| text == name).map(|(_, code)| code.as_str())
    }

    /// Returns the names of all stored code.
    pub fn names(&self) -> Vec<&str> {
        self.0.iter().map(|(name, _)| name.as_str()).collect()
    }

    /// Returns all names except `name`.
    pub fn names_without(&self, name: &str) -> Vec<&str> {
        self.names().into_iter().filter(|text| *text != name).collect()
    }

    /// Returns all names, each with its code.
    pub fn entries(&self) -> &[(String, String)] {
        &self.0
    }

    fn store(&mut self, name: &str, code: &str) {
        match self.0.iter_mut().find(|(text, _)| text == name) {
            Some((_, old)) => code.clone_into(old),
            None => self.0.push((name.to_owned(), code.to_owned())),
        }
    }

    fn remove(&mut self, name: &str) {
        self.0.retain(|(text, _)| text != name);
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

    /// Returns the named code of a section.
    pub fn statements(&self, what: NotebookSection) -> &NamedStatements {
        match what {
            NotebookSection::Calculation => &self.calculations,
            NotebookSection::Script => &self.scripts,
        }
    }

    fn statements_mut(&mut self, what: NotebookSection) -> &mut NamedStatements {
        match what {
            NotebookSection::Calculation => &mut self.calculations,
            NotebookSection::Script => &mut self.scripts,
        }
    }

    /// Rejects a change that would exceed a quota. A session checks only new calls. Calls that older versions recorded
    /// are applied without this check.
    ///
    /// # Errors
    /// `quota_exceeded`, with the limit.
    pub fn check_quota(&self, change: &NotebookChange) -> Result<(), Rejection> {
        let NotebookChange::Store { section: what, name, code } = change else { return Ok(()) };
        let refused = |field: &str, message: String| {
            let message = format!("{message}; nothing was stored and nothing was removed");
            Err(Rejection::for_field(field, QUOTA_EXCEEDED, message))
        };
        let bytes = |count: usize| grouped_number(count as f64, 0);
        if name.len() > MAX_NAME_BYTES {
            return refused(
                "name",
                format!("the name has {} bytes, but at most {MAX_NAME_BYTES} are allowed", bytes(name.len())),
            );
        }
        if code.len() > MAX_CODE_BYTES {
            let (size, most) = (bytes(code.len()), bytes(MAX_CODE_BYTES));
            return refused("code", format!("the code has {size} bytes, but at most {most} are allowed"));
        }
        let stored = self.statements(*what);
        if stored.get(name).is_none() && stored.entries().len() >= MAX_ENTRIES {
            let kind = match what {
                NotebookSection::Calculation => "calculations",
                NotebookSection::Script => "scripts",
            };
            return refused("name", format!("a run can have at most {MAX_ENTRIES} {kind}; delete one first"));
        }
        let entries = self.calculations.entries().iter().chain(self.scripts.entries());
        let kept: usize = entries.map(|(name, code)| name.len() + code.len()).sum();
        let replaced = stored.get(name).map_or(0, |code| name.len() + code.len());
        let after = kept - replaced + name.len() + code.len();
        if after > MAX_BYTES {
            let (after, most) = (bytes(after), bytes(MAX_BYTES));
            let message = format!(
                "scripts and calculations would have {after} bytes together, but at most {most} are allowed; delete some first"
            );
            return refused("code", message);
        }
        Ok(())
    }

    /// Applies a change to the notebook.
    pub fn apply(&mut self, change: &NotebookChange) {
        match change {
            NotebookChange::Store { section: what, name, code } => {
                self.statements_mut(*what).store(name, code)
            }
            NotebookChange::Remove { section: what, name } => self.statements_mut(*what).remove(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ToolId;

    #[test]
    fn quotas_limit_names_code_counts_and_total() {
        let keep = |what: NotebookSection, name: &str, bytes: usize| NotebookChange::Store {
            section: what,
            name: name.to_owned(),
            code: "x".repeat(bytes),
        };
        let field = |notebook: &Notebook, change: &NotebookChange| {
            notebook.check_quota(change).err().map(|rejection| (rejection.code, rejection.field))
        };
        let beyond = |field: &str| Some((QUOTA_EXCEEDED, Some(field.to_owned())));
        let mut notebook = Notebook::new();
        assert_eq!(field(&notebook, &keep(NotebookSection::Script, &"n".repeat(201), 1)), beyond("name"));
        assert_eq!(field(&notebook, &keep(NotebookSection::Script, "a", MAX_CODE_BYTES + 1)), beyond("code"));
        assert_eq!(field(&notebook, &keep(NotebookSection::Script, "a", MAX_CODE_BYTES)), None);
        for number in 0..MAX_ENTRIES {
            notebook.apply(&keep(NotebookSection::Script, &format!("s{number}"), 1));
        }
        assert_eq!(field(&notebook, &keep(NotebookSection::Script, "another", 1)), beyond("name"));
        assert_eq!(field(&notebook, &keep(NotebookSection::Script, "s7", 2)), None, "it replaces one");
        assert_eq!(field(&notebook, &keep(NotebookSection::Calculation, "another", 1)), None);
        for number in 0..15 {
            notebook.apply(&keep(NotebookSection::Script, &format!("s{number}"), MAX_CODE_BYTES));
        }
        let room = MAX_BYTES - (15 * MAX_CODE_BYTES + 85 + 10 * 2 + 90 * 3);
        assert_eq!(field(&notebook, &keep(NotebookSection::Calculation, "c", room - 1)), None);
        assert_eq!(field(&notebook, &keep(NotebookSection::Calculation, "c", room)), beyond("code"));
        assert_eq!(
            field(&notebook, &keep(NotebookSection::Script, "s0", MAX_CODE_BYTES)),
            None,
            "it replaces itself"
        );
        for tool in [ToolId::RegisterScript, ToolId::RegisterDailyCalculation] {
            for quota in [MAX_ENTRIES, MAX_CODE_BYTES, MAX_NAME_BYTES, MAX_BYTES] {
                assert!(tool.spec().effect.contains(&grouped_number(quota as f64, 0)), "{tool}: {quota}");
            }
        }
    }

    #[test]
    fn replaced_statements_keep_their_position() {
        let mut notebook = Notebook::new();
        let what = NotebookSection::Calculation;
        let keep = |name: &str, code: &str| NotebookChange::Store {
            section: what,
            name: name.to_owned(),
            code: code.to_owned(),
        };
        for change in [keep("a", "SELECT 1"), keep("b", "SELECT 2"), keep("a", "SELECT 3")] {
            notebook.apply(&change);
        }
        assert_eq!(notebook.statements(what).names(), ["a", "b"]);
        assert_eq!(notebook.statements(what).get("a"), Some("SELECT 3"));
        assert!(notebook.statements(NotebookSection::Script).names().is_empty());
        notebook.apply(&NotebookChange::Remove { section: what, name: "a".to_owned() });
        assert_eq!(notebook.statements(what).entries(), [("b".to_owned(), "SELECT 2".to_owned())]);
    }
}
