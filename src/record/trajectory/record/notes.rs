//! Queries and saved notes.

use serde::{Deserialize, Serialize};

/// A query of the database.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Query {
    /// Statement.
    pub sql: String,
    /// Rows of the result; `None` without a result.
    pub rows: Option<u64>,
    /// Whether more rows exist than were returned.
    pub truncated: bool,
    /// Error code.
    pub error: Option<String>,
    /// Error message.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Whether the user cancelled it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
    /// Source of the statement; `None` in lines of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub via: Option<QuerySource>,
    /// Duration in milliseconds.
    pub took_ms: f64,
}

/// Source of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QuerySource {
    /// The user typed it.
    Typed,
    /// A query of the library, unchanged.
    Library,
    /// The rows behind a figure.
    DrillDown,
    /// The program derived it from a result: counts, pivots.
    Derived,
    /// A Python script.
    Script,
    /// A program, over HTTP or the Model Context Protocol.
    Program,
}

/// Saved notes in lines of format 1; their text is in a separate file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memo {
    /// BLAKE3 digest of the text, in hexadecimal digits.
    pub digest: String,
    /// Bytes of the text.
    pub length: u64,
}

/// Saved notes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Note {
    /// BLAKE3 digest of the text, in hexadecimal digits.
    pub digest: String,
    /// Bytes of the text.
    pub length: u64,
    /// The text; `None` if the rules mask it.
    pub text: Option<String>,
}
