//! Tools for scripts: SQL statements or Python code that runs immediately or is stored under a name.
//!
//! SQL statements run with the guard and the limits of a query, and their output contains the results as tables. Python
//! needs python3 and runs in a separate process, which uses the same guarded queries.

mod delete_script;
mod language;
mod list_scripts;
mod python_exec;
mod register_script;
mod run_script;

pub use delete_script::DeleteScript;
pub use language::{Language, python_marker_hint};
pub use list_scripts::ListScripts;
pub use python_exec::PythonExec;
pub use register_script::RegisterScript;
pub use run_script::RunScript;

use super::arguments::{Arguments, text_argument};
use super::notebook::{NamedStatements, NotebookSection};
use super::rejection::Rejection;
use super::tool_context::ToolContext;

/// Description of the argument `code`.
pub(super) const CODE_DESCRIPTION: &str = "read-only SQL statements, separated by ;, or Python, whose first line begins with #. Python \
                               has query(sql), which returns a list of dicts, and get_vars(), and prints its \
                               output; it cannot call tools or change files";

const MAX_SCRIPT_SECONDS: f64 = 600.0;

fn stored_scripts<'a>(view: &ToolContext<'a>) -> &'a NamedStatements {
    view.session().notebook().statements(NotebookSection::Script)
}

fn script_name(arguments: &Arguments) -> Result<String, Rejection> {
    Ok(text_argument(arguments, "name")?.trim().to_owned())
}

fn find_script<'a>(name: &str, view: &ToolContext<'a>) -> Result<&'a str, Rejection> {
    stored_scripts(view).get(name).ok_or_else(|| {
        let names = stored_scripts(view).names();
        let known = if names.is_empty() {
            "none is stored".to_owned()
        } else {
            format!("stored: {}", names.join(", "))
        };
        Rejection::for_field("name", "script_not_found", format!("script {name} does not exist; {known}"))
    })
}
