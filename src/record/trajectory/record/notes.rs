//! Queries and saved notes.

use serde::{Deserialize, Serialize};

/// An SQL statement that was executed in the database, with its outcome.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Query {
    /// SQL text that was executed.
    pub sql: String,
    /// Number of returned rows; `None` if the query failed.
    pub rows: Option<u64>,
    /// Whether the result was truncated to the maximum number of rows.
    pub truncated: bool,
    /// Error code of a failed query.
    pub error: Option<String>,
    /// Error message of a failed query.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Whether the user cancelled the query.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
    /// Source of the statement; `None` in lines of format 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub via: Option<QuerySource>,
    /// Duration of the query in milliseconds.
    pub took_ms: f64,
}

/// Source of an SQL statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QuerySource {
    /// Statement that the user typed.
    Typed,
    /// Unchanged query of the query library.
    Library,
    /// Statement that shows the rows behind a figure.
    DrillDown,
    /// Statement that the program derived from a result, for example a count or a pivot.
    Derived,
    /// Statement of a Python script.
    Script,
    /// Statement of a program that uses HTTP or the Model Context Protocol.
    Program,
}

/// Saved notes in lines of format 1. The text of the notes is in a separate file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memo {
    /// BLAKE3 digest of the notes, in hexadecimal digits.
    pub digest: String,
    /// Length of the notes, in bytes.
    pub length: u64,
}

/// Saved notes of the player.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Note {
    /// BLAKE3 digest of the notes, in hexadecimal digits.
    pub digest: String,
    /// Length of the notes, in bytes.
    pub length: u64,
    /// Text of the notes; `None` if the session rules mask free text.
    pub text: Option<String>,
}
