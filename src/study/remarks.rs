//! What an experimenter notes about a session: `remarks.jsonl` in the folder of runs, lines of their own.

use std::path::Path;

use serde::{Deserialize, Serialize};

use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::append_synced;
use novamind_record::files::read_regular_text;

/// Name of the file.
pub const REMARKS: &str = "remarks.jsonl";

/// A remark.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remark {
    /// When, RFC 3339.
    pub at: String,
    /// Whom it is about: a label.
    pub participant: String,
    /// What the experimenter says.
    pub text: String,
}

/// Writes a remark.
///
/// # Errors
/// The file cannot be written.
pub fn write_remark(runs: &Path, participant: &str, text: &str) -> Result<(), RunError> {
    let path = runs.join(REMARKS);
    let remark = Remark { at: now(), participant: participant.to_owned(), text: text.to_owned() };
    let line = serde_json::to_string(&remark).unwrap_or_default() + "\n";
    append_synced(&path, line.as_bytes())
}

/// The remarks of a folder of runs; lines that cannot be read are left out.
pub fn remarks(runs: &Path) -> Vec<Remark> {
    let text = read_regular_text(&runs.join(REMARKS));
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}
