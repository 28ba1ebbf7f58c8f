//! Scripts: SQL statements or Python that are run at once, or kept under a name.
//!
//! A script of statements needs nothing but the program: its output are their results as tables, under the guard and the
//! limits of a query. Python needs python3 and runs in a process of its own, which asks the same guarded queries.

mod delete_script;
mod language;
mod list_scripts;
mod python_exec;
mod register_script;
mod run_script;

pub use delete_script::DeleteScript;
pub use language::{Language, hint_at_python};
pub use list_scripts::ListScripts;
pub use python_exec::PythonExec;
pub use register_script::RegisterScript;
pub use run_script::RunScript;

use super::arguments::{Arguments, text};
use super::notebook::{Kept, NamedStatements};
use super::refusal::Refusal;
use super::view::View;

/// What code may be, for whoever writes some.
pub(super) const CODE: &str = "read-only SQL statements, separated by ;, or Python, whose first line begins with #. Python \
                               has query(sql), which returns a list of dicts, and get_vars(), and prints what it has to \
                               say; it can call no tool and change no file";

/// A script runs at most this long, in seconds.
const LONGEST_SECONDS: f64 = 600.0;

/// The scripts of the run.
fn stored<'a>(view: &View<'a>) -> &'a NamedStatements {
    view.surroundings().notebook().statements(Kept::Script)
}

/// The name of a script that the argument `name` gives.
fn name_of(arguments: &Arguments) -> Result<String, Refusal> {
    Ok(text(arguments, "name")?.trim().to_owned())
}

/// The code of a stored script.
fn find<'a>(name: &str, view: &View<'a>) -> Result<&'a str, Refusal> {
    stored(view).get(name).ok_or_else(|| {
        let names = stored(view).names();
        let known = if names.is_empty() {
            "none is stored".to_owned()
        } else {
            format!("stored: {}", names.join(", "))
        };
        Refusal::at("name", "script_not_found", format!("script {name} does not exist; {known}"))
    })
}
