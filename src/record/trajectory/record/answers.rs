//! Questions of a study, and their answers.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A question that was shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// Questionnaire it belongs to.
    pub questionnaire: String,
    /// When it is asked: `before`, `week 4`, `break`, `end`.
    pub occasion: String,
    /// Name of the question.
    pub id: String,
    /// Its text as it was shown.
    pub text: String,
    /// `likert`, `number`, `choice`, `text` or `attention`.
    pub form: String,
    /// What could be chosen, where something could.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub options: Vec<String>,
}

/// The answer to a question.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answered {
    /// Questionnaire.
    pub questionnaire: String,
    /// When it was asked.
    pub occasion: String,
    /// Name of the question.
    pub id: String,
    /// A number, a text, a list of options; null if it was passed over.
    pub value: Value,
    /// Whether it is the expected one, of attention checks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub as_expected: Option<bool>,
    /// Milliseconds from showing to answering.
    pub for_ms: u64,
    /// How often the answer was changed before.
    pub changes: u32,
}
