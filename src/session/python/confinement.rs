//! The restriction of script processes in hosted sessions.
//!
//! The program that hosts sessions provides the restriction, for example with Landlock. The restriction applies to one
//! thread and to the processes that the thread starts, so this process keeps its access to the run.

use std::io::{Error, Result};
use std::path::Path;
use std::process::{Child, Command};
use std::sync::OnceLock;

/// Restricts the calling thread, and the processes that it starts, to the folder of a script.
pub type ScriptRestriction = fn(&Path) -> Result<()>;

static RESTRICTION: OnceLock<ScriptRestriction> = OnceLock::new();

/// Restricts every script that this process starts later. A script that cannot be restricted is not started.
/// Later calls have no effect.
pub fn restrict_scripts(restriction: ScriptRestriction) {
    let _ = RESTRICTION.set(restriction);
}

/// Returns whether scripts are restricted. Restricted scripts use only interpreters with a fixed path.
pub(super) fn is_restricted() -> bool {
    RESTRICTION.get().is_some()
}

/// Starts a process in the folder of a script, with the restriction if there is one.
pub(super) fn spawn(command: &mut Command, folder: &Path) -> Result<Child> {
    let Some(restrict) = RESTRICTION.get() else { return command.spawn() };
    let start = || restrict(folder).and_then(|()| command.spawn());
    // The thread ends after the start, so that the restriction affects only the script.
    std::thread::scope(|scope| scope.spawn(start).join())
        .unwrap_or_else(|_| Err(Error::other("the script cannot be restricted")))
}
