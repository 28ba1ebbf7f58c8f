//! Negotiations with companies.

mod reading;
mod reject_enterprise_deal;
mod send_enterprise_deal;

pub use reject_enterprise_deal::RejectEnterpriseDeal;
pub use send_enterprise_deal::SendEnterpriseDeal;

use serde_json::{Map, Value, json};

use super::refusal::Refusal;
use super::spec::Output;

/// What became of one element of a list of deals.
#[derive(Debug, Clone, PartialEq)]
enum Fate {
    /// It was sent.
    Done(u32),
    /// It was not, and why.
    Failed(Failure),
}

/// Why an element of a list of deals was not sent; the others are.
#[derive(Debug, Clone, PartialEq)]
struct Failure {
    /// The customer, where the element names one.
    customer: Option<i64>,
    /// Words of the result.
    error: String,
    /// The refusal, if no element is sent.
    refusal: Refusal,
    /// It could not be read; such elements stand first in the result.
    unreadable: bool,
}

impl Failure {
    fn unreadable(customer: Option<i64>, error: impl Into<String>, refusal: Refusal) -> Failure {
        Failure { customer, error: error.into(), refusal, unreadable: true }
    }

    fn of(customer: i64, error: &str, refusal: Refusal) -> Failure {
        Failure { customer: Some(customer), error: error.to_owned(), refusal, unreadable: false }
    }
}

/// The results of a call: what could not be read first, then the rest in the order of the call.
fn results(fates: &[Fate]) -> Value {
    let unreadable = |fate: &&Fate| matches!(fate, Fate::Failed(Failure { unreadable: true, .. }));
    let first = fates.iter().filter(unreadable);
    let rest = fates.iter().filter(|fate| !unreadable(fate));
    let list: Vec<Value> = first.chain(rest).map(result).collect();
    json!({ "results": list })
}

fn result(fate: &Fate) -> Value {
    match fate {
        Fate::Done(customer) => json!({ "customer_id": customer, "success": true }),
        Fate::Failed(failure) => {
            let mut map = Map::new();
            if let Some(customer) = failure.customer {
                map.insert("customer_id".to_owned(), customer.into());
            }
            map.insert("error".to_owned(), failure.error.as_str().into());
            Value::Object(map)
        }
    }
}

/// Refuses a call of which nothing is sent, with the reason of its first element.
fn unless_all_failed(fates: &[Fate]) -> Result<(), Refusal> {
    let failed = |fate: &Fate| match fate {
        Fate::Failed(failure) => Some(failure.refusal.clone()),
        Fate::Done(_) => None,
    };
    let refusals: Vec<Refusal> = fates.iter().filter_map(failed).collect();
    match refusals.into_iter().next() {
        Some(first) if fates.iter().all(|fate| matches!(fate, Fate::Failed(_))) => Err(first),
        _ => Ok(()),
    }
}

const RESULTS: &[Output] = &[Output {
    name: "results",
    kind: "list of {customer_id, success} or {customer_id, error}",
    doc: "one entry per deal: those that could not be read first, then the others in the order of the call",
}];
