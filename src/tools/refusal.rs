//! The only way in which the game says no.

use std::fmt;

use serde::Serialize;

use super::deal_results::DealResult;

/// A refused call: nothing was changed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Refusal {
    /// Code, for programs.
    pub code: &'static str,
    /// What is wrong and what would be right, for people.
    pub message: String,
    /// Path of the argument at fault, for instance `targeted_spend.linkedin.E9`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<String>,
    /// Of a call with several deals, all refused: what is wrong with each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub results: Vec<DealResult>,
}

impl Refusal {
    /// A refusal that blames no single argument.
    pub fn new(code: &'static str, message: impl Into<String>) -> Refusal {
        Refusal { code, message: message.into(), field: None, results: Vec::new() }
    }

    /// A refusal that blames an argument.
    pub fn at(field: impl Into<String>, code: &'static str, message: impl Into<String>) -> Refusal {
        Refusal { code, message: message.into(), field: Some(field.into()), results: Vec::new() }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.field {
            Some(field) => write!(formatter, "{} ({field}): {}", self.code, self.message),
            None => write!(formatter, "{}: {}", self.code, self.message),
        }
    }
}

impl std::error::Error for Refusal {}
