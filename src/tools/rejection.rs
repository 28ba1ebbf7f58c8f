//! Rejections of tool calls.

use std::fmt;

use serde::Serialize;

/// The rejection of a tool call. A rejected call changes nothing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Rejection {
    /// Code that programs can test, for example `wrong_type`.
    pub code: &'static str,
    /// Message that explains the error and names the valid values.
    pub message: String,
    /// Path of the invalid argument, for example `targeted_spend.linkedin.E9`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<String>,
    /// Result of each deal, if the call has several deals and all were rejected.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub results: Vec<DealResult>,
}

impl Rejection {
    /// Returns a rejection that does not refer to an argument.
    pub fn new(code: &'static str, message: impl Into<String>) -> Rejection {
        Rejection { code, message: message.into(), field: None, results: Vec::new() }
    }

    /// Returns a rejection that names the invalid argument.
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

/// Results of the deals in a call. Deals that could not be parsed are listed first. All other deals follow in the
/// order of the call.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DealResults {
    /// One result for each deal.
    pub results: Vec<DealResult>,
}

/// The result of a single deal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum DealResult {
    /// The offer was sent or the thread was ended.
    Done {
        /// Number of the customer.
        customer_id: u32,
        /// Always true, as in the released simulator.
        success: bool,
    },
    /// The deal failed.
    Failed {
        /// Customer number in the deal; absent if the deal contains no number.
        #[serde(skip_serializing_if = "Option::is_none")]
        customer_id: Option<i64>,
        /// Reason for the failure.
        error: String,
    },
}

impl DealResult {
    /// Returns the customer number if the deal succeeded.
    pub fn sent_customer(&self) -> Option<u32> {
        match self {
            DealResult::Done { customer_id, .. } => Some(*customer_id),
            DealResult::Failed { .. } => None,
        }
    }
}
