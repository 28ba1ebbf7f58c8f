//! Rejections of tool calls.

use std::fmt;

use serde::Serialize;

/// A rejected call, which has changed nothing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Rejection {
    /// Code, for programs.
    pub code: &'static str,
    /// Message with the error and the valid values.
    pub message: String,
    /// Path of the invalid argument, for example `targeted_spend.linkedin.E9`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<String>,
    /// Reasons for each deal, if a call has several deals and all were rejected.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub results: Vec<DealResult>,
}

impl Rejection {
    /// Returns a rejection without an argument.
    pub fn new(code: &'static str, message: impl Into<String>) -> Rejection {
        Rejection { code, message: message.into(), field: None, results: Vec::new() }
    }

    /// Returns a rejection of an argument.
    pub fn for_field(field: impl Into<String>, code: &'static str, message: impl Into<String>) -> Rejection {
        Rejection { code, message: message.into(), field: Some(field.into()), results: Vec::new() }
    }
}

impl fmt::Display for Rejection {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.field {
            Some(field) => write!(formatter, "{} ({field}): {}", self.code, self.message),
            None => write!(formatter, "{}: {}", self.code, self.message),
        }
    }
}

impl std::error::Error for Rejection {}

/// Results of the deals of a call: first those that could not be parsed, then the others in the order of the call.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DealResults {
    /// One entry per deal.
    pub results: Vec<DealResult>,
}

/// Result of a deal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum DealResult {
    /// The offer was sent, or the thread ended.
    Done {
        /// Customer.
        customer_id: u32,
        /// Always true.
        success: bool,
    },
    /// The deal failed.
    Failed {
        /// Customer, if the deal names one.
        #[serde(skip_serializing_if = "Option::is_none")]
        customer_id: Option<i64>,
        /// Reason.
        error: String,
    },
}

impl DealResult {
    /// Returns the customer of a deal that was sent.
    pub fn sent_customer(&self) -> Option<u32> {
        match self {
            DealResult::Done { customer_id, .. } => Some(*customer_id),
            DealResult::Failed { .. } => None,
        }
    }
}
