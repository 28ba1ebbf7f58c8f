//! Questions and answers of a study.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A study question that was shown to the participant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuestionShown {
    /// Name of the questionnaire.
    pub questionnaire: String,
    /// Occasion of the questionnaire, for example `before`, `week 4`, `break` or `end`.
    pub occasion: String,
    /// Name of the question.
    pub id: String,
    /// Text of the question as shown.
    pub text: String,
    /// Answer format: `likert`, `number`, `choice`, `text` or `attention`.
    pub form: String,
    /// Options that the participant can choose; empty for questions without options.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub options: Vec<String>,
}

/// The answer to a study question.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QuestionAnswer {
    /// Name of the questionnaire.
    pub questionnaire: String,
    /// Occasion of the questionnaire.
    pub occasion: String,
    /// Name of the question.
    pub id: String,
    /// Answer: a number, a text, or a list of options; null if the question was skipped.
    pub value: Value,
    /// Whether the participant gave the expected answer; attention checks only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub as_expected: Option<bool>,
    /// Milliseconds from showing the question to the answer.
    pub for_ms: u64,
    /// Number of times the answer was changed before it was submitted.
    pub changes: u32,
}
