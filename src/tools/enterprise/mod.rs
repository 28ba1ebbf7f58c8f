//! Negotiations with enterprises.

mod addressed;
mod reading;
mod reject_enterprise_deal;
mod send_enterprise_deal;

pub use addressed::{highest_named, readdressed};
pub use reject_enterprise_deal::RejectEnterpriseDeal;
pub use send_enterprise_deal::SendEnterpriseDeal;

use super::refusal::Refusal;
use super::refusal::{DealResult, DealResults};
use super::spec::Output;

#[derive(Debug, Clone, PartialEq)]
enum Fate {
    /// Sent to this customer.
    Done(u32),
    /// Not sent.
    Failed(Failure),
}

impl Fate {
    fn of(outcome: Result<u32, Failure>) -> Fate {
        outcome.map_or_else(Fate::Failed, Fate::Done)
    }
}

/// Why an element of a list of deals was not sent. Other elements are sent.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// Customer, if the element names one.
    customer: Option<i64>,
    /// Error in the result.
    error: String,
    /// Rejection of the call, if no element is sent.
    refusal: Box<Refusal>,
    /// Whether the element could not be parsed. Such elements come first in the result.
    unreadable: bool,
}

impl Failure {
    fn unreadable(customer: Option<i64>, error: impl Into<String>, refusal: Refusal) -> Failure {
        Failure { customer, error: error.into(), refusal: refusal.into(), unreadable: true }
    }

    fn of(customer: i64, error: &str, refusal: Refusal) -> Failure {
        Failure {
            customer: Some(customer),
            error: error.to_owned(),
            refusal: refusal.into(),
            unreadable: false,
        }
    }
}

fn results(fates: Vec<Fate>) -> DealResults {
    let unreadable = |fate: &Fate| matches!(fate, Fate::Failed(Failure { unreadable: true, .. }));
    let (first, rest): (Vec<Fate>, Vec<Fate>) = fates.into_iter().partition(unreadable);
    DealResults { results: first.into_iter().chain(rest).map(result).collect() }
}

fn result(fate: Fate) -> DealResult {
    match fate {
        Fate::Done(customer_id) => DealResult::Done { customer_id, success: true },
        Fate::Failed(failure) => DealResult::Failed { customer_id: failure.customer, error: failure.error },
    }
}

/// Rejects a call if no element was sent, with the reason of the first element and the results of all.
fn unless_all_failed(fates: Vec<Fate>) -> Result<DealResults, Refusal> {
    let refused = match fates.first() {
        Some(Fate::Failed(first)) if fates.iter().all(|fate| matches!(fate, Fate::Failed(_))) => {
            Some((*first.refusal).clone())
        }
        _ => None,
    };
    let DealResults { results } = results(fates);
    match refused {
        Some(refusal) => Err(Refusal { results, ..refusal }),
        None => Ok(DealResults { results }),
    }
}

const RESULTS: &[Output] = &[Output {
    name: "results",
    kind: "list of {customer_id, success} or {customer_id, error}",
    doc: "one entry per deal: first those that could not be parsed, then the others in the order of the call",
}];
