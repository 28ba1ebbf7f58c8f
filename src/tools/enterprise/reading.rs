//! Parsing of deals in all accepted notations.

use serde_json::Value;

use super::super::arguments::{integer, wrong_type};
use super::{Failure, Refusal};
use novamind_world::events::Offering;
use novamind_world::identifiers::Plan;

/// Returns the elements of the argument; a value that is not a list is a single element.
///
/// # Errors
/// `deals_missing` if there are none.
pub(super) fn elements(given: Option<&Value>, example: &str) -> Result<Vec<Value>, Refusal> {
    let missing = || {
        let message = format!("deals are required: a list of at least one, for instance {example}");
        Refusal::at("deals", "deals_missing", message)
    };
    match given {
        None | Some(Value::Null | Value::Bool(false)) => Err(missing()),
        Some(Value::Array(list)) if list.is_empty() => Err(missing()),
        Some(Value::Object(map)) if map.is_empty() => Err(missing()),
        Some(Value::String(text)) if text.is_empty() => Err(missing()),
        Some(Value::Array(list)) => Ok(list.clone()),
        Some(single) => Ok(vec![single.clone()]),
    }
}

/// An error of parsing an element.
pub(super) enum Unreadable {
    /// An invalid number, which rejects the whole call.
    Call(Refusal),
    /// An error of this element only.
    Element(Failure),
}

impl Unreadable {
    /// Converts any error to an error of this element only.
    pub(super) fn of_element(self) -> Failure {
        match self {
            Unreadable::Element(failure) => failure,
            Unreadable::Call(refusal) => {
                let refusal = Refusal { code: "deal_malformed", ..refusal };
                Failure::unreadable(None, "invalid format", refusal)
            }
        }
    }
}

impl From<Failure> for Unreadable {
    fn from(failure: Failure) -> Unreadable {
        Unreadable::Element(failure)
    }
}

/// Parses a customer number: an integer, also as text.
///
/// # Errors
/// `customer_missing`, `wrong_type`.
pub(super) fn customer(given: Option<&Value>, path: &str) -> Result<i64, Unreadable> {
    let field = format!("{path}.customer_id");
    match given {
        None | Some(Value::Null) => {
            let refusal = Refusal::at(field, "customer_missing", "the deal names no customer");
            Err(Failure::unreadable(None, "missing customer_id", refusal).into())
        }
        Some(Value::String(text)) => {
            text.trim().parse().map_err(|_| Unreadable::Call(wrong_type(&field, "a customer number")))
        }
        Some(value) => {
            integer(value).ok_or_else(|| Unreadable::Call(wrong_type(&field, "a customer number")))
        }
    }
}

/// Returns the error of an element that is not a deal.
pub(super) fn malformed(path: &str, expected: &str) -> Unreadable {
    let refusal = Refusal::at(path, "deal_malformed", format!("{path} is not a deal: {expected}"));
    Failure::unreadable(None, "invalid format", refusal).into()
}

/// Parses all offerings of a deal and returns the first `most`.
///
/// # Errors
/// `offerings_missing`, `offering_short`, `offering_no_price`, `offering_malformed`, `wrong_type`.
pub(super) fn offerings(
    given: Option<&Value>,
    customer: i64,
    most: usize,
    path: &str,
) -> Result<Vec<Offering>, Unreadable> {
    let Some(list) = given.and_then(Value::as_array).filter(|list| !list.is_empty()) else {
        let message =
            format!("the deal with customer {customer} needs a list of offerings: [plan, price], …");
        let refusal = Refusal::at(format!("{path}.offerings"), "offerings_missing", message);
        return Err(Failure::unreadable(Some(customer), "offerings required", refusal).into());
    };
    let mut offerings = list
        .iter()
        .enumerate()
        .map(|(at, value)| offering(value, at, customer, &format!("{path}.offerings.{at}")))
        .collect::<Result<Vec<Offering>, Unreadable>>()?;
    offerings.truncate(most);
    Ok(offerings)
}

fn offering(given: &Value, at: usize, customer: i64, path: &str) -> Result<Offering, Unreadable> {
    let failed = |code: &'static str, what: &str, message: String| -> Unreadable {
        let refusal = Refusal::at(path, code, message);
        Failure::unreadable(Some(customer), format!("offering {at} {what}"), refusal).into()
    };
    let (plan, price) = match given {
        Value::Array(pair) => match pair.as_slice() {
            [plan, price, ..] => (Some(plan), price),
            _ => {
                let message = "an offering needs a plan and a price, for instance [\"B\", 31.5]".to_owned();
                return Err(failed("offering_short", "too short", message));
            }
        },
        Value::Object(map) => {
            let mut prices = ["price", "price_per_seat"].into_iter().filter_map(|name| map.get(name));
            match prices.find(|price| !price.is_null()) {
                Some(price) => (map.get("plan"), price),
                None => {
                    let message =
                        "an offering needs price_per_seat, in dollars per seat and month".to_owned();
                    return Err(failed("offering_no_price", "missing price", message));
                }
            }
        }
        _ => {
            let message = "write an offering as [plan, price] or {plan, price_per_seat}".to_owned();
            return Err(failed("offering_malformed", "invalid", message));
        }
    };
    let plan = match plan {
        None => Plan::B,
        Some(plan) => plan.as_str().and_then(Plan::parse).ok_or_else(|| {
            let message = format!("plan {plan} does not exist; the plans are A, B, C");
            failed("offering_malformed", "invalid", message)
        })?,
    };
    let price = number(price).ok_or_else(|| {
        Unreadable::Call(wrong_type(&format!("{path}.price_per_seat"), "a price in dollars"))
    })?;
    if price < 0.0 {
        let message = format!("a price of {price} is below 0");
        return Err(failed("offering_malformed", "invalid", message));
    }
    Ok(Offering { plan, price })
}

fn number(given: &Value) -> Option<f64> {
    let number = match given {
        Value::String(text) => text.trim().parse().ok(),
        other => other.as_f64(),
    };
    number.filter(|number| number.is_finite())
}
