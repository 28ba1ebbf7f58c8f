//! The Python client: a package of the standard library alone, its modules made of the catalogue.

mod module;

use std::path::Path;

use crate::session::RunError;
use crate::tools::{Module, Numbers};

const CONNECTION: &str = include_str!("../../../assets/client/connection.py");
const PACKAGE: &str = include_str!("../../../assets/client/package.py");
const PROJECT: &str = include_str!("../../../assets/client/pyproject.toml");
const NOTEBOOK: &str = include_str!("../../../assets/client/twelve-weeks.ipynb");

/// Writes the package into a folder, where `pip install` takes it; what it wrote before is replaced.
///
/// # Errors
/// The folder cannot be written.
pub fn write_client(folder: &Path) -> Result<(), RunError> {
    let package = folder.join("novamind");
    std::fs::create_dir_all(&package).map_err(RunError::io(&package))?;
    let numbers = Numbers::shipped();
    let mut files = vec![
        (folder.join("pyproject.toml"), PROJECT.replace("{version}", env!("CARGO_PKG_VERSION"))),
        (folder.join("twelve-weeks.ipynb"), NOTEBOOK.to_owned()),
        (package.join("__init__.py"), PACKAGE.to_owned()),
        (package.join("connection.py"), CONNECTION.to_owned()),
        (package.join("py.typed"), String::new()),
    ];
    files.extend(Module::ALL.map(|module| {
        (package.join(format!("{}.py", module::name(module))), module::text(module, &numbers))
    }));
    files.iter().try_for_each(|(path, text)| std::fs::write(path, text).map_err(RunError::io(path)))
}
