//! Tools for negotiations with enterprises.

mod parsing;
mod reject_enterprise_deal;
mod remapping;
mod send_enterprise_deal;

pub use reject_enterprise_deal::RejectEnterpriseDeal;
pub use remapping::{highest_customer, remap_customers};
pub use send_enterprise_deal::SendEnterpriseDeal;

use super::rejection::Rejection;
use super::rejection::{DealResult, DealResults};
use super::spec::ResultField;

#[derive(Debug, Clone, PartialEq)]
enum ElementOutcome {
    /// The offer or rejection was sent to this customer.
    Sent(u32),
    /// The offer or rejection was not sent.
    Failed(ElementFailure),
}

impl ElementOutcome {
    fn from_result(outcome: Result<u32, ElementFailure>) -> ElementOutcome {
        outcome.map_or_else(ElementOutcome::Failed, ElementOutcome::Sent)
    }
}

/// The reason why one element of a list of deals was not sent. The remaining elements of the list are sent.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementFailure {
    /// Customer number; `None` if the element contains no valid number.
    customer: Option<i64>,
    /// Reason that the result of the call states for the element.
    error: String,
    /// Rejection of the whole call, used if no element is sent.
    refusal: Box<Rejection>,
    /// Whether the element could not be parsed. The result lists such elements first.
    is_unreadable: bool,
}

impl ElementFailure {
    fn unreadable(customer: Option<i64>, error: impl Into<String>, refusal: Rejection) -> ElementFailure {
        ElementFailure { customer, error: error.into(), refusal: refusal.into(), is_unreadable: true }
    }

    fn new(customer: i64, error: &str, refusal: Rejection) -> ElementFailure {
        ElementFailure {
            customer: Some(customer),
            error: error.to_owned(),
            refusal: refusal.into(),
            is_unreadable: false,
        }
    }
}

fn to_deal_results(outcomes: Vec<ElementOutcome>) -> DealResults {
    let unreadable = |outcome: &ElementOutcome| {
        matches!(outcome, ElementOutcome::Failed(ElementFailure { is_unreadable: true, .. }))
    };
    let (first, rest): (Vec<ElementOutcome>, Vec<ElementOutcome>) =
        outcomes.into_iter().partition(unreadable);
    DealResults { results: first.into_iter().chain(rest).map(to_deal_result).collect() }
}

fn to_deal_result(outcome: ElementOutcome) -> DealResult {
    match outcome {
        ElementOutcome::Sent(customer_id) => DealResult::Done { customer_id, success: true },
        ElementOutcome::Failed(failure) => {
            DealResult::Failed { customer_id: failure.customer, error: failure.error }
        }
    }
}

/// Rejects a call if no element was sent. The rejection states why the first element was not sent, and contains the
/// results of all elements.
fn reject_if_all_failed(outcomes: Vec<ElementOutcome>) -> Result<DealResults, Rejection> {
    let refused = match outcomes.first() {
        Some(ElementOutcome::Failed(first))
            if outcomes.iter().all(|outcome| matches!(outcome, ElementOutcome::Failed(_))) =>
        {
            Some((*first.refusal).clone())
        }
        _ => None,
    };
    let DealResults { results } = to_deal_results(outcomes);
    match refused {
        Some(refusal) => Err(Rejection { results, ..refusal }),
        None => Ok(DealResults { results }),
    }
}

const RESULT_FIELDS: &[ResultField] = &[ResultField {
    name: "results",
    kind: "list of {customer_id, success} or {customer_id, error}",
    description: "one entry per deal: first those that could not be parsed, then the others in the order of the call",
}];
