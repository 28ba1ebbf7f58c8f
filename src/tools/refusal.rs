//! The only way in which the game says no.

use std::fmt;

use serde::Serialize;

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

/// What became of each deal of a call: what could not be read first, then the rest in the order of the call.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DealResults {
    /// One entry per deal.
    pub results: Vec<DealResult>,
}

/// What became of a deal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum DealResult {
    /// It was sent, or the thread ended.
    Done {
        /// The company.
        customer_id: u32,
        /// Always true.
        success: bool,
    },
    /// It was not.
    Failed {
        /// The customer, where the deal names one.
        #[serde(skip_serializing_if = "Option::is_none")]
        customer_id: Option<i64>,
        /// Why.
        error: String,
    },
}

impl DealResult {
    /// The company of a deal that was sent.
    pub fn done(&self) -> Option<u32> {
        match self {
            DealResult::Done { customer_id, .. } => Some(*customer_id),
            DealResult::Failed { .. } => None,
        }
    }
}
