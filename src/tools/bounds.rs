//! Limits of numbers in arguments, which keep all sums of money exact.
//!
//! A session checks them for new calls only. Recorded calls of older versions can have larger numbers and are replayed
//! unchanged.

use serde_json::Value;

use super::arguments::Arguments;
use super::refusal::Refusal;
use super::spec::{ArgumentKind, MOST_DOLLARS, Spec};
use novamind_base::notation::grouped;

/// Maximum magnitude of a forecast, in dollars.
pub const MOST_FORECAST: f64 = 1e15;

/// Rejection code.
pub const CODE: &str = "amount_too_large";

/// Rejects arguments with a number beyond its limit.
///
/// # Errors
/// `amount_too_large`, with the path of the first such number.
pub fn hold(spec: &Spec, arguments: &Arguments) -> Result<(), Refusal> {
    for (name, value) in arguments.as_map() {
        let own = |name: &str| spec.arguments.iter().find(|one| one.name == name || one.alias == Some(name));
        let Some(argument) = own(name) else { continue };
        let bound = match argument.kind {
            ArgumentKind::Number(range)
            | ArgumentKind::Integer(range)
            | ArgumentKind::Map(_, range)
            | ArgumentKind::Matrix(_, _, range) => range.bound,
            ArgumentKind::Deals(_) => MOST_DOLLARS,
            ArgumentKind::Text | ArgumentKind::Structure(_) => continue,
        };
        check(value, bound, name, argument.unit)?;
    }
    Ok(())
}

/// Rejects a number beyond a limit at any depth of a value.
fn check(value: &Value, bound: f64, path: &str, unit: &str) -> Result<(), Refusal> {
    let within = |name: &str, value: &Value| check(value, bound, &format!("{path}.{name}"), unit);
    match value {
        Value::Array(list) => {
            // The first element of a deal is the number of its customer.
            let is_deal = matches!(list.as_slice(), [_, Value::Array(_), ..]) && !list[0].is_array();
            let values = list.iter().enumerate().skip(usize::from(is_deal));
            values.into_iter().try_for_each(|(at, value)| within(&at.to_string(), value))
        }
        Value::Object(map) => {
            let mut values = map.iter().filter(|(name, _)| *name != "customer_id");
            values.try_for_each(|(name, value)| within(name, value))
        }
        Value::Number(number) => refuse_beyond(number.as_f64().unwrap_or(f64::INFINITY), bound, path, unit),
        // Prices of deals may also be texts.
        Value::String(text) => {
            let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
            number.map_or(Ok(()), |number| refuse_beyond(number, bound, path, unit))
        }
        Value::Null | Value::Bool(_) => Ok(()),
    }
}

/// Rejects a number beyond a limit.
pub(super) fn refuse_beyond(number: f64, bound: f64, path: &str, unit: &str) -> Result<(), Refusal> {
    if number.abs() <= bound { Ok(()) } else { Err(too_large(bound, path, unit)) }
}

/// Returns the rejection of a number beyond a limit.
pub(super) fn too_large(bound: f64, path: &str, unit: &str) -> Refusal {
    let most = match unit.strip_prefix('$') {
        Some(rest) => format!("${}{rest}", grouped(bound, 0)),
        None => format!("{} {unit}", grouped(bound, 0)),
    };
    Refusal::at(path, CODE, format!("{path} is too large: at most {most}"))
}
