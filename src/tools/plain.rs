//! Values of settings as forms and lines show them: whole numbers without a decimal point.

use serde::{Serialize, Serializer};
use serde_json::Value;

use novamind_base::notation::plain_numbers;

/// Writes a field without a decimal point if its number is whole, where the release returns an integer.
///
/// # Errors
/// Those of the serialiser.
pub(super) fn plain<T: Serialize, S: Serializer>(data: &T, serializer: S) -> Result<S::Ok, S::Error> {
    let value = serde_json::to_value(data).map_err(serde::ser::Error::custom)?;
    plain_numbers(value).serialize(serializer)
}

/// Data as the JSON of a call.
pub(super) fn as_data(data: &impl Serialize) -> Value {
    serde_json::to_value(data).map_or(Value::Null, plain_numbers)
}
