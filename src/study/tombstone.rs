//! `withdrawn.toml` in a participant's folder of runs, which records that they withdrew.

use std::path::Path;

use serde::Serialize;

use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::{create_folder, write_whole};

/// Name of the file.
const FILE: &str = "withdrawn.toml";

/// The record of a withdrawal and the erased runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Tombstone {
    /// Erased runs, separated by spaces.
    run: String,
    /// Digest of the study's protocol.
    study: String,
    /// Time of erasure, RFC 3339.
    at: String,
}

impl Tombstone {
    /// Records that runs of a study are erased now.
    pub(crate) fn of(runs: &[String], study: &str) -> Tombstone {
        Tombstone { run: runs.join(" "), study: study.to_owned(), at: now() }
    }

    /// Whether a folder of runs has the file. Its contents are not read.
    pub(crate) fn is_in(folder: &Path) -> bool {
        folder.join(FILE).exists()
    }

    /// Writes the file into a folder of runs.
    ///
    /// # Errors
    /// Fails if the folder cannot be written.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), RunError> {
        create_folder(folder)?;
        write_whole(&folder.join(FILE), toml::to_string(self).unwrap_or_default().as_bytes())
    }
}
