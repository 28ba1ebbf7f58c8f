//! The body of a request: one JSON object of limited size that must arrive within a time limit.

use std::time::Duration;

use axum::body::{Body, to_bytes};
use serde_json::{Map, Value};

use crate::not_numbers;
use crate::request::{Answer, Status};
use novamind_tools::Refusal;

/// Maximum size of a body in bytes.
const MOST_BYTES: usize = 1024 * 1024;
/// Maximum time for a body to arrive.
const DEADLINE: Duration = Duration::from_secs(30);

/// The fields of a body.
#[derive(Debug)]
pub struct Fields {
    fields: Map<String, Value>,
    /// Rejection of a body that was read but contains a value that JSON cannot represent.
    pub refusal: Option<Refusal>,
}

impl Fields {
    /// Removes and returns a field, or null if it is missing.
    pub fn take(&mut self, name: &str) -> Value {
        self.fields.remove(name).unwrap_or(Value::Null)
    }

    /// Returns the remaining fields.
    pub fn rest(self) -> Value {
        self.fields.into()
    }
}

/// Reads a body.
///
/// # Errors
/// The body is too large, too slow, not valid JSON, or not an object.
pub async fn read_object(body: Body) -> Result<Fields, Answer> {
    let read = tokio::time::timeout(DEADLINE, to_bytes(body, MOST_BYTES)).await;
    let bytes = match read {
        Err(_) => {
            let message = format!("the body did not arrive within {} s", DEADLINE.as_secs());
            return Err(Answer::wrong(Status::TooSlow, "body_timeout", message));
        }
        Ok(Err(_)) => {
            let message = format!("the body must be complete and have at most {MOST_BYTES} bytes");
            return Err(Answer::wrong(Status::TooLarge, "body_too_large", message));
        }
        Ok(Ok(bytes)) => bytes,
    };
    let malformed = |message: String| Answer::wrong(Status::Refused, "malformed_json", message);
    match serde_json::from_slice(&bytes) {
        Ok(Value::Object(fields)) => Ok(Fields { fields, refusal: None }),
        Ok(_) => Err(malformed("the body must be a JSON object".to_owned())),
        Err(error) => match not_numbers::read(&bytes) {
            Some((Value::Object(fields), refusal)) => Ok(Fields { fields, refusal: Some(refusal) }),
            _ => Err(malformed(format!("the body is not valid JSON: {error}"))),
        },
    }
}
