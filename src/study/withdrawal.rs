//! `withdrawn.toml` in a participant's folder of runs, which records that they withdrew.

use std::path::Path;

use serde::Serialize;

use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::{create_folder, write_atomically};

/// Name of the file.
const WITHDRAWAL_FILE: &str = "withdrawn.toml";

/// The record of a withdrawal and the erased runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct WithdrawalRecord {
    /// Erased runs, separated by spaces.
    run: String,
    /// Digest of the study's protocol.
    study: String,
    /// Time of erasure, RFC 3339.
    at: String,
}

impl WithdrawalRecord {
    /// Records that runs of a study are erased now.
    pub(crate) fn new(runs: &[String], study: &str) -> WithdrawalRecord {
        WithdrawalRecord { run: runs.join(" "), study: study.to_owned(), at: now() }
    }

    /// Returns whether a folder of runs has the file. Its contents are not read.
    pub(crate) fn exists_in(folder: &Path) -> bool {
        folder.join(WITHDRAWAL_FILE).exists()
    }

    /// Writes the file into a folder of runs.
    ///
    /// # Errors
    /// Fails if the folder cannot be written.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), RunError> {
        create_folder(folder)?;
        write_atomically(&folder.join(WITHDRAWAL_FILE), toml::to_string(self).unwrap_or_default().as_bytes())
    }
}
