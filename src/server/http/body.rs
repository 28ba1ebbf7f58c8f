//! Reads the body of a request: one JSON object of limited size that must arrive within a time limit.

use std::time::Duration;

use axum::body::{Body, to_bytes};
use serde_json::{Map, Value};

use crate::non_finite;
use crate::request::{ApiResponse, ResponseStatus};
use novamind_tools::Rejection;

/// Maximum size of a request body in bytes.
const MAX_BODY_BYTES: usize = 1024 * 1024;
/// Time limit for the arrival of a request body.
const BODY_DEADLINE: Duration = Duration::from_secs(30);

/// The fields of a request body, which routes take one by one.
#[derive(Debug)]
pub struct BodyFields {
    fields: Map<String, Value>,
    /// Rejection if the body contains a literal that JSON does not allow, such as `NaN`.
    pub rejection: Option<Rejection>,
}

impl BodyFields {
    /// Removes and returns a field of the body. Returns null if the field is missing.
    pub fn take(&mut self, name: &str) -> Value {
        self.fields.remove(name).unwrap_or(Value::Null)
    }

    /// Returns a field of the body, or null if the field is missing.
    pub fn get(&self, name: &str) -> &Value {
        self.fields.get(name).unwrap_or(&Value::Null)
    }

    /// Returns all fields that were not taken, as one object.
    pub fn into_remaining(self) -> Value {
        self.fields.into()
    }
}

/// Reads the body of a request.
///
/// # Errors
/// The body is too large, too slow, not valid JSON, or not an object.
pub async fn read_object(body: Body) -> Result<BodyFields, ApiResponse> {
    let read = tokio::time::timeout(BODY_DEADLINE, to_bytes(body, MAX_BODY_BYTES)).await;
    let bytes = match read {
        Err(_) => {
            let message = format!("the body did not arrive within {} s", BODY_DEADLINE.as_secs());
            return Err(ApiResponse::invalid_request(ResponseStatus::TooSlow, "body_timeout", message));
        }
        Ok(Err(_)) => {
            let message = format!("the body must be complete and have at most {MAX_BODY_BYTES} bytes");
            return Err(ApiResponse::invalid_request(ResponseStatus::TooLarge, "body_too_large", message));
        }
        Ok(Ok(bytes)) => bytes,
    };
    let malformed =
        |message: String| ApiResponse::invalid_request(ResponseStatus::BadRequest, "malformed_json", message);
    match serde_json::from_slice(&bytes) {
        Ok(Value::Object(fields)) => Ok(BodyFields { fields, rejection: None }),
        Ok(_) => Err(malformed("the body must be a JSON object".to_owned())),
        Err(error) => match non_finite::parse_with_non_finite_numbers(&bytes) {
            Some((Value::Object(fields), refusal)) => Ok(BodyFields { fields, rejection: Some(refusal) }),
            _ => Err(malformed(format!("the body is not valid JSON: {error}"))),
        },
    }
}
