//! Limits for numbers in arguments. The limits keep all sums of money exact.
//!
//! A session checks these limits only for new calls. Recorded calls of older versions can have larger numbers and are
//! replayed unchanged.

use serde_json::Value;

use super::arguments::Arguments;
use super::rejection::Rejection;
use super::spec::{ArgumentKind, MAX_DOLLARS, ToolSpec};
use novamind_base::formatting::grouped_number;

/// Maximum magnitude of a forecast, in dollars.
pub const MAX_FORECAST_DOLLARS: f64 = 1e15;

/// Rejection code for numbers beyond their limit.
pub const REJECTION_CODE: &str = "amount_too_large";

/// Rejects arguments with a number beyond its limit.
///
/// # Errors
/// `amount_too_large`, with the path of the first such number.
pub fn check_arguments(spec: &ToolSpec, arguments: &Arguments) -> Result<(), Rejection> {
    for (name, value) in arguments.as_map() {
        let find_argument =
            |name: &str| spec.arguments.iter().find(|one| one.name == name || one.alias == Some(name));
        let Some(argument) = find_argument(name) else { continue };
        let bound = match argument.kind {
            ArgumentKind::Number(range)
            | ArgumentKind::Integer(range)
            | ArgumentKind::Map(_, range)
            | ArgumentKind::Matrix(_, _, range) => range.magnitude_limit,
            ArgumentKind::Deals(_) => MAX_DOLLARS,
            ArgumentKind::Text | ArgumentKind::Structure(_) => continue,
        };
        check_value(value, bound, name, argument.unit)?;
    }
    Ok(())
}

/// Rejects a value that contains a number beyond a limit, at any depth.
fn check_value(value: &Value, bound: f64, path: &str, unit: &str) -> Result<(), Rejection> {
    let within = |name: &str, value: &Value| check_value(value, bound, &format!("{path}.{name}"), unit);
    match value {
        Value::Array(list) => {
            // Skip the customer number, the first element of a deal.
            let is_deal = matches!(list.as_slice(), [_, Value::Array(_), ..]) && !list[0].is_array();
            let values = list.iter().enumerate().skip(usize::from(is_deal));
            values.into_iter().try_for_each(|(at, value)| within(&at.to_string(), value))
        }
        Value::Object(map) => {
            let mut values = map.iter().filter(|(name, _)| *name != "customer_id");
            values.try_for_each(|(name, value)| within(name, value))
        }
        Value::Number(number) => check_number(number.as_f64().unwrap_or(f64::INFINITY), bound, path, unit),
        // Prices of deals may also be texts.
        Value::String(text) => {
            let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
            number.map_or(Ok(()), |number| check_number(number, bound, path, unit))
        }
        Value::Null | Value::Bool(_) => Ok(()),
    }
}

/// Rejects a number beyond a limit.
pub(super) fn check_number(number: f64, bound: f64, path: &str, unit: &str) -> Result<(), Rejection> {
    if number.abs() <= bound { Ok(()) } else { Err(too_large_rejection(bound, path, unit)) }
}

/// Returns the rejection of a number beyond a limit.
pub(super) fn too_large_rejection(bound: f64, path: &str, unit: &str) -> Rejection {
    let max = match unit.strip_prefix('$') {
        Some(rest) => format!("${}{rest}", grouped_number(bound, 0)),
        None => format!("{} {unit}", grouped_number(bound, 0)),
    };
    Rejection::for_field(path, REJECTION_CODE, format!("{path} is too large: at most {max}"))
}
