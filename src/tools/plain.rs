//! Numbers as answers write them: whole ones without a decimal point.

use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::notation::plain_numbers;

/// Data whose numbers are written plainly.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[serde(transparent)]
pub struct Plain<T: Serialize>(#[serde(serialize_with = "plain")] pub T);

/// Writes a field plainly.
///
/// # Errors
/// Those of the serialiser.
pub(super) fn plain<T: Serialize, S: Serializer>(data: &T, serializer: S) -> Result<S::Ok, S::Error> {
    let value = serde_json::to_value(data).map_err(serde::ser::Error::custom)?;
    plain_numbers(value).serialize(serializer)
}

/// Data as the JSON of a call or an answer, written plainly.
pub(super) fn as_data(data: &impl Serialize) -> Value {
    serde_json::to_value(Plain(data)).unwrap_or(Value::Null)
}
