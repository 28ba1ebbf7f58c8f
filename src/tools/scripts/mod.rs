//! Scripts: SQL statements or Python code that run at once, or are stored under a name.
//!
//! The output of statements are their results as tables, with the guard and the limits of a query. Python needs python3 and
//! runs in a separate process, which uses the same guarded queries.

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

/// Description of the argument `code`.
pub(super) const CODE: &str = "read-only SQL statements, separated by ;, or Python, whose first line begins with #. Python \
                               has query(sql), which returns a list of dicts, and get_vars(), and prints its \
                               output; it cannot call tools or change files";

const LONGEST_SECONDS: f64 = 600.0;

fn stored<'a>(view: &View<'a>) -> &'a NamedStatements {
    view.surroundings().notebook().statements(Kept::Script)
}

fn name_of(arguments: &Arguments) -> Result<String, Refusal> {
    Ok(text(arguments, "name")?.trim().to_owned())
}

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
