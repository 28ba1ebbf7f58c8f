//! Parses deals in all accepted notations.

use serde_json::Value;

use super::super::arguments::{json_i64, wrong_type_rejection};
use super::{ElementFailure, Rejection};
use novamind_world::events::Offering;
use novamind_world::identifiers::Plan;

/// Returns the elements of the argument `deals`. A value that is not a list is treated as a single element.
///
/// # Errors
/// `deals_missing` if there are no elements.
pub(super) fn parse_elements(given: Option<&Value>, example: &str) -> Result<Vec<Value>, Rejection> {
    let missing = || {
        let message = format!("deals are required: a list of at least one, for instance {example}");
        Rejection::for_field("deals", "deals_missing", message)
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

/// An error that occurred while parsing an element.
pub(super) enum ElementError {
    /// An invalid number, for which the whole call is rejected.
    Call(Rejection),
    /// An error that affects only this element.
    Element(ElementFailure),
}

impl ElementError {
    /// Converts the error to an error that affects only this element.
    pub(super) fn into_element_failure(self) -> ElementFailure {
        match self {
            ElementError::Element(failure) => failure,
            ElementError::Call(refusal) => {
                let refusal = Rejection { code: "deal_malformed", ..refusal };
                ElementFailure::unreadable(None, "invalid format", refusal)
            }
        }
    }
}

impl From<ElementFailure> for ElementError {
    fn from(failure: ElementFailure) -> ElementError {
        ElementError::Element(failure)
    }
}

/// Parses a customer number, which may be an integer or a text that contains an integer.
///
/// # Errors
/// `customer_missing`, `wrong_type`.
pub(super) fn parse_deal_customer(given: Option<&Value>, path: &str) -> Result<i64, ElementError> {
    let field = format!("{path}.customer_id");
    match given {
        None | Some(Value::Null) => {
            let refusal = Rejection::for_field(field, "customer_missing", "the deal names no customer");
            Err(ElementFailure::unreadable(None, "missing customer_id", refusal).into())
        }
        Some(Value::String(text)) => text
            .trim()
            .parse()
            .map_err(|_| ElementError::Call(wrong_type_rejection(&field, "a customer number"))),
        Some(value) => json_i64(value)
            .ok_or_else(|| ElementError::Call(wrong_type_rejection(&field, "a customer number"))),
    }
}

/// Returns the error for an element that is not a deal.
pub(super) fn malformed_element(path: &str, expected: &str) -> ElementError {
    let refusal = Rejection::for_field(path, "deal_malformed", format!("{path} is not a deal: {expected}"));
    ElementFailure::unreadable(None, "invalid format", refusal).into()
}

/// Parses all offerings of a deal. Returns at most `max_offerings` offerings.
///
/// # Errors
/// `offerings_missing`, `offering_short`, `offering_no_price`, `offering_malformed`, `wrong_type`.
pub(super) fn parse_offerings(
    given: Option<&Value>,
    customer: i64,
    max_offerings: usize,
    path: &str,
) -> Result<Vec<Offering>, ElementError> {
    let Some(list) = given.and_then(Value::as_array).filter(|list| !list.is_empty()) else {
        let message =
            format!("the deal with customer {customer} needs a list of offerings: [plan, price], …");
        let refusal = Rejection::for_field(format!("{path}.offerings"), "offerings_missing", message);
        return Err(ElementFailure::unreadable(Some(customer), "offerings required", refusal).into());
    };
    let mut offerings = list
        .iter()
        .enumerate()
        .map(|(at, value)| parse_offering(value, at, customer, &format!("{path}.offerings.{at}")))
        .collect::<Result<Vec<Offering>, ElementError>>()?;
    offerings.truncate(max_offerings);
    Ok(offerings)
}

fn parse_offering(given: &Value, at: usize, customer: i64, path: &str) -> Result<Offering, ElementError> {
    let failed = |code: &'static str, what: &str, message: String| -> ElementError {
        let refusal = Rejection::for_field(path, code, message);
        ElementFailure::unreadable(Some(customer), format!("offering {at} {what}"), refusal).into()
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
                        "an offering needs price_per_seat, in dollars per seat per month".to_owned();
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
    let price = parse_number(price).ok_or_else(|| {
        ElementError::Call(wrong_type_rejection(&format!("{path}.price_per_seat"), "a price in dollars"))
    })?;
    if price < 0.0 {
        let message = format!("a price of {price} is below 0");
        return Err(failed("offering_malformed", "invalid", message));
    }
    Ok(Offering { plan, price })
}

fn parse_number(given: &Value) -> Option<f64> {
    let number = match given {
        Value::String(text) => text.trim().parse().ok(),
        other => other.as_f64(),
    };
    number.filter(|number| number.is_finite())
}
