//! The Python client: a package without dependencies, whose modules are generated from the catalog.

mod module;

use std::path::{Path, PathBuf};

use novamind_record::error::RunError;
use novamind_record::files::write_atomically;
use novamind_tools::{ParameterNumbers, ToolModule};

pub use module::module_name;

const CONNECTION: &str = include_str!("../../../assets/client/connection.py");
const PACKAGE: &str = include_str!("../../../assets/client/package.py");
const PROJECT: &str = include_str!("../../../assets/client/pyproject.toml");
const NOTEBOOK: &str = include_str!("../../../assets/client/twelve-weeks.ipynb");

/// Writes the Python package to a folder, so that `pip install` can install it from there. Replaces the files of an
/// earlier client.
///
/// # Errors
/// The folder cannot be written.
pub fn write_client(folder: &Path) -> Result<(), RunError> {
    let package = folder.join("novamind");
    std::fs::create_dir_all(&package).map_err(RunError::io(&package))?;
    let numbers = ParameterNumbers::bundled();
    let mut files = vec![
        (folder.join("pyproject.toml"), PROJECT.replace("{version}", env!("CARGO_PKG_VERSION"))),
        (folder.join("twelve-weeks.ipynb"), NOTEBOOK.to_owned()),
        (package.join("__init__.py"), PACKAGE.to_owned()),
        (package.join("connection.py"), CONNECTION.to_owned()),
        (package.join("py.typed"), String::new()),
    ];
    files.extend(ToolModule::ALL.map(|module| {
        (package.join(format!("{}.py", module::module_name(module))), module::module_source(module, &numbers))
    }));
    // Files are replaced atomically, because a program may be reading them.
    let is_new =
        |(path, text): &&(PathBuf, String)| std::fs::read(path).ok().as_deref() != Some(text.as_bytes());
    files.iter().filter(is_new).try_for_each(|(path, text)| write_atomically(path, text.as_bytes()))
}
