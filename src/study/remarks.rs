//! The experimenter's remarks on sessions: `remarks.jsonl` in the folder of runs.

use std::path::Path;

use serde::{Deserialize, Serialize};

use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::append_synced;
use novamind_record::files::read_regular_text_or_empty;

/// Name of the file that contains the experimenter's remarks.
pub const REMARKS_FILE: &str = "remarks.jsonl";

/// A remark of the experimenter on a participant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remark {
    /// Time of the remark, RFC 3339.
    pub at: String,
    /// Label of the participant.
    pub participant: String,
    /// Text of the remark.
    pub text: String,
}

/// Appends a remark to the file in a folder of runs.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub fn write_remark(runs: &Path, participant: &str, text: &str) -> Result<(), RunError> {
    let path = runs.join(REMARKS_FILE);
    let remark = Remark { at: now(), participant: participant.to_owned(), text: text.to_owned() };
    let line = serde_json::to_string(&remark).unwrap_or_default() + "\n";
    append_synced(&path, line.as_bytes())
}

/// Returns the remarks in a folder of runs. Skips lines that cannot be parsed.
pub fn read_remarks(runs: &Path) -> Vec<Remark> {
    let text = read_regular_text_or_empty(&runs.join(REMARKS_FILE));
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}
