//! What is left where a participant has withdrawn: `withdrawn.toml` in the folder of their runs.

use std::path::Path;

use serde::Serialize;

use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::{create_folder, write_whole};

/// Name of the file.
const FILE: &str = "withdrawn.toml";

/// That somebody has withdrawn, and which runs were erased.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Tombstone {
    /// Runs that were erased, with blanks between them.
    run: String,
    /// Digest of the study's protocol.
    study: String,
    /// When they were erased, RFC 3339.
    at: String,
}

impl Tombstone {
    /// That these runs of a study are erased now.
    pub(crate) fn of(runs: &[String], study: &str) -> Tombstone {
        Tombstone { run: runs.join(" "), study: study.to_owned(), at: now() }
    }

    /// Whether there is one in a folder of runs, whatever it says.
    pub(crate) fn is_in(folder: &Path) -> bool {
        folder.join(FILE).exists()
    }

    /// Leaves it in a folder of runs.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), RunError> {
        create_folder(folder)?;
        write_whole(&folder.join(FILE), toml::to_string(self).unwrap_or_default().as_bytes())
    }
}
