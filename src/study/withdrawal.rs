//! `withdrawn.toml` in a participant's folder of runs, which records the participant's withdrawal.

use std::path::Path;

use serde::Serialize;

use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::{create_folder, write_atomically};

/// Name of the file that records a withdrawal.
const WITHDRAWAL_FILE: &str = "withdrawn.toml";

/// The record of a withdrawal, which lists the erased runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct WithdrawalRecord {
    /// IDs of the erased runs, separated by spaces.
    run: String,
    /// Digest of the study's protocol.
    study: String,
    /// Time of erasure, RFC 3339.
    at: String,
}

impl WithdrawalRecord {
    /// Creates the record of a withdrawal from a study, with the erased runs and the current time.
    pub(crate) fn new(runs: &[String], study: &str) -> WithdrawalRecord {
        WithdrawalRecord { run: runs.join(" "), study: study.to_owned(), at: now() }
    }

    /// Returns whether a folder of runs contains the file `withdrawn.toml`. The contents of the file are not read.
    pub(crate) fn exists_in(folder: &Path) -> bool {
        folder.join(WITHDRAWAL_FILE).exists()
    }

    /// Writes `withdrawn.toml` to a folder of runs.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be written.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), RunError> {
        create_folder(folder)?;
        write_atomically(&folder.join(WITHDRAWAL_FILE), toml::to_string(self).unwrap_or_default().as_bytes())
    }
}
