//! The body of a request: one JSON object of bounded size that arrives in bounded time.

use std::time::Duration;

use axum::body::{Body, to_bytes};
use serde_json::{Map, Value};

use crate::not_numbers;
use crate::request::{Answer, Status};
use novamind_tools::Refusal;

/// Bytes of a body.
const MOST_BYTES: usize = 1024 * 1024;
/// A body that takes longer is not waited for.
const DEADLINE: Duration = Duration::from_secs(30);

/// The fields of a body.
#[derive(Debug)]
pub struct Fields {
    fields: Map<String, Value>,
    /// Why the request is refused although the body was read: a value that JSON cannot hold.
    pub refusal: Option<Refusal>,
}

impl Fields {
    /// A field; null if it is not there.
    pub fn take(&mut self, name: &str) -> Value {
        self.fields.remove(name).unwrap_or(Value::Null)
    }

    /// All fields that are left.
    pub fn rest(self) -> Value {
        self.fields.into()
    }
}

/// Reads a body.
///
/// # Errors
/// It is too large, too slow, no JSON, or no object.
pub async fn read_object(body: Body) -> Result<Fields, Answer> {
    let read = tokio::time::timeout(DEADLINE, to_bytes(body, MOST_BYTES)).await;
    let bytes = match read {
        Err(_) => {
            let message = format!("the body did not arrive within {} seconds", DEADLINE.as_secs());
            return Err(Answer::wrong(Status::TooSlow, "body_timeout", message));
        }
        Ok(Err(_)) => {
            let message = format!("the body must be whole and have at most {MOST_BYTES} bytes");
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
            _ => Err(malformed(format!("the body is no JSON: {error}"))),
        },
    }
}
