//! Scripts: SQL statements that are run at once, or kept under a name.
//!
//! Agents run Python here. A console has none, so a script is a list of read-only statements, its output their
//! results as tables; the session runs them under the guard and the limits of a query.

mod delete_script;
mod list_scripts;
mod python_exec;
mod register_script;
mod run_script;

pub use delete_script::DeleteScript;
pub use list_scripts::ListScripts;
pub use python_exec::PythonExec;
pub use register_script::RegisterScript;
pub use run_script::RunScript;

use super::arguments::{Arguments, text};
use super::notebook::{Kept, NamedStatements};
use super::refusal::Refusal;
use super::view::View;

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

/// The statements of a stored script.
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
