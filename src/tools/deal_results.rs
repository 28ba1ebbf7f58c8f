//! What became of the deals of a call, one by one.

use serde::Serialize;

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
