//! What was asked of the database, and the notes that were kept.

use serde::{Deserialize, Serialize};

/// A question to the database.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Query {
    /// Statement.
    pub sql: String,
    /// Rows of the answer; none if there is none.
    pub rows: Option<u64>,
    /// There were more rows than are shown.
    pub truncated: bool,
    /// Code of what was wrong.
    pub error: Option<String>,
    /// What was wrong, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// The person stopped it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
    /// Where the statement came from; none in lines of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub via: Option<QuerySource>,
    /// Milliseconds it took.
    pub took_ms: f64,
}

/// Where a statement came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QuerySource {
    /// The person wrote it.
    Typed,
    /// A query of the library, unchanged.
    Library,
    /// The rows behind a figure.
    DrillDown,
    /// The program made it of a result: counts, pivots.
    Derived,
    /// A script in Python.
    Script,
    /// A program, over HTTP or the Model Context Protocol.
    Program,
}

/// The notes as they were kept, in lines of format 1; their text is in a file of its own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memo {
    /// blake3 digest of the text, in hexadecimal digits.
    pub digest: String,
    /// Bytes of the text.
    pub length: u64,
}

/// The notes as they were kept.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Note {
    /// blake3 digest of the text, in hexadecimal digits.
    pub digest: String,
    /// Bytes of the text.
    pub length: u64,
    /// The text, unless the rules mask it.
    pub text: Option<String>,
}
