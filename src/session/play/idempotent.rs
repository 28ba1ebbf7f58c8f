//! Idempotent requests: a request with an id runs once, and retries return the first response.

use serde_json::Value;

use super::Session;
use super::advance::{WeekSubmission, week_arguments};
use super::tool_call::CallMetadata;
use crate::company::idempotency::{IdempotentResponse, payload_mismatch_rejection};
use crate::company::reports::WeekResult;
use novamind_record::trajectory::record::{Outcome, RejectionRecord, RequestId, Via};
use novamind_tools::{Rejection, ToolId, find};

const MAX_ID_CHARACTERS: usize = 128;

/// A request from a program to simulate a week.
#[derive(Debug, Clone, Copy)]
pub struct WeekRequest<'a> {
    /// Rationale of the week.
    pub rationale: &'a Value,
    /// Forecasts of cash for four horizons.
    pub predictions: &'a Value,
    /// Day on which the caller expects the run to be; null to skip the check.
    pub expected_day: &'a Value,
    /// ID of the request; null if the request has no id.
    pub id: &'a Value,
}

enum RequestState {
    /// A new request, with the request id to record.
    New(Option<RequestId>),
    /// A retry, with the response to the first request.
    Repeated(IdempotentResponse),
}

/// Returns the request id in a JSON value, or `None` if the value is not a text of 1 to 128 characters.
pub fn request_id(value: &Value) -> Option<&str> {
    value.as_str().filter(|id| (1..=MAX_ID_CHARACTERS).contains(&id.chars().count()))
}

fn parse_request_id(id: &Value) -> Result<Option<&str>, Rejection> {
    match (id, request_id(id)) {
        (Value::Null, _) => Ok(None),
        (_, Some(id)) => Ok(Some(id)),
        _ => {
            let message = format!("request_id must be a text of 1 to {MAX_ID_CHARACTERS} characters");
            Err(Rejection::for_field("request_id", "request_id_invalid", message))
        }
    }
}

impl Session {
    /// Calls a tool like [`Session::call`], but only once per request id: a retry returns the first response. Tools
    /// that only read or execute code ignore the id.
    ///
    /// # Errors
    /// The rejections of the call; `request_id_invalid`, `request_id_payload_mismatch`.
    pub fn call_once(
        &mut self,
        tool: impl AsRef<str>,
        arguments: &Value,
        via: Via,
        id: &Value,
    ) -> Result<Value, RejectionRecord> {
        let tool = tool.as_ref();
        let ignores_id = find(tool).is_some_and(|tool| !tool.spec().id.takes_request_id());
        let id = if ignores_id { &Value::Null } else { id };
        match self.request_state(tool, arguments, id) {
            Err(rejection) => {
                self.record_rejection(tool, arguments, via, &rejection, None);
                Err(rejection.into())
            }
            Ok(RequestState::Repeated(IdempotentResponse::Call(Outcome::Accepted(answer)))) => Ok(answer),
            Ok(RequestState::Repeated(IdempotentResponse::Call(Outcome::Rejected(rejection)))) => {
                Err(rejection)
            }
            Ok(RequestState::Repeated(IdempotentResponse::Week(_))) => {
                Err(payload_mismatch_rejection().into())
            }
            Ok(RequestState::New(request)) => {
                let answer =
                    self.call_with_metadata(tool, arguments, via, CallMetadata { reversal: None, request })?;
                Ok(answer.to_json())
            }
        }
    }

    /// Simulates a week like [`Session::advance_with_json`], but only once per request id and only on the expected day.
    ///
    /// # Errors
    /// The rejections of the week; `unexpected_day`, `request_id_invalid`, `request_id_payload_mismatch`.
    pub fn advance_once(
        &mut self,
        request: &WeekRequest<'_>,
        via: Via,
    ) -> Result<WeekResult, RejectionRecord> {
        let WeekRequest { rationale, predictions, expected_day, id } = *request;
        let args = week_arguments(rationale, predictions, expected_day);
        let name = ToolId::NextWeek.name();
        match self.request_state(name, &args, id) {
            Err(rejection) => {
                self.record_rejection(name, &args, via, &rejection, None);
                Err(rejection.into())
            }
            Ok(RequestState::Repeated(IdempotentResponse::Week(week))) => Ok(*week),
            Ok(RequestState::Repeated(IdempotentResponse::Call(Outcome::Rejected(rejection)))) => {
                Err(rejection)
            }
            Ok(RequestState::Repeated(IdempotentResponse::Call(Outcome::Accepted(_)))) => {
                Err(payload_mismatch_rejection().into())
            }
            Ok(RequestState::New(request)) => {
                let submission = WeekSubmission {
                    rationale,
                    predictions,
                    filled_naively: [false; 4],
                    expected_day,
                    request,
                };
                Ok(self.submit_week(submission, via, &mut |_| {})?)
            }
        }
    }

    /// Returns the stored response to the request with this id, or `None` if no executed request has the id.
    pub fn stored_response(&self, id: &str) -> Option<&IdempotentResponse> {
        self.history.idempotent_responses.find_by_id(id)
    }

    /// Returns whether a request is new or a retry.
    ///
    /// # Errors
    /// One of the rejections `request_id_invalid`, `request_id_payload_mismatch`.
    fn request_state(&self, tool: &str, args: &Value, id: &Value) -> Result<RequestState, Rejection> {
        let Some(id) = parse_request_id(id)? else { return Ok(RequestState::New(None)) };
        let request = RequestId::new(id, tool, args);
        let first = self.history.idempotent_responses.find(&request)?.cloned();
        Ok(first.map_or_else(|| RequestState::New(Some(request)), RequestState::Repeated))
    }
}
