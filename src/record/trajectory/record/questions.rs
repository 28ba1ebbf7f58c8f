//! Questions and answers of a study.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A question that was shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuestionShown {
    /// Questionnaire.
    pub questionnaire: String,
    /// Occasion: `before`, `week 4`, `break`, `end`.
    pub occasion: String,
    /// Name of the question.
    pub id: String,
    /// Text as shown.
    pub text: String,
    /// `likert`, `number`, `choice`, `text` or `attention`.
    pub form: String,
    /// Options, for questions with choices.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub options: Vec<String>,
}

/// The answer to a question.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuestionAnswer {
    /// Questionnaire.
    pub questionnaire: String,
    /// Occasion.
    pub occasion: String,
    /// Name of the question.
    pub id: String,
    /// A number, a text, or a list of options; null if the question was skipped.
    pub value: Value,
    /// Whether the answer is the expected one; attention checks only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub as_expected: Option<bool>,
    /// Milliseconds from the question to the answer.
    pub for_ms: u64,
    /// Number of changes before the answer was submitted.
    pub changes: u32,
}
