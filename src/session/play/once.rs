//! Idempotent requests: a request with an id runs once, and retries return the first response.

use serde_json::Value;

use super::Session;
use super::act::Marks;
use super::advance::{Filing, arguments_of_week};
use crate::company::first_answers::{FirstAnswer, mismatch};
use crate::company::reports::Week;
use novamind_record::trajectory::record::{Outcome, RefusalRecord, RequestId, Via};
use novamind_tools::{Refusal, ToolId, find};

const MAX_ID_CHARACTERS: usize = 128;

/// A request to simulate a week, from a program.
#[derive(Debug, Clone, Copy)]
pub struct WeekRequest<'a> {
    /// Rationale.
    pub rationale: &'a Value,
    /// Forecasts for four horizons.
    pub predictions: &'a Value,
    /// The day on which the run must be; null for any.
    pub expected_day: &'a Value,
    /// The id of the request; null without one.
    pub id: &'a Value,
}

enum Sent {
    /// A new request, with the id to record.
    New(Option<RequestId>),
    /// A retry, with the first response.
    Again(FirstAnswer),
}

fn id_of(id: &Value) -> Result<Option<&str>, Refusal> {
    match id {
        Value::Null => Ok(None),
        Value::String(id) if (1..=MAX_ID_CHARACTERS).contains(&id.chars().count()) => Ok(Some(id)),
        _ => {
            let message = format!("request_id must be a text of 1 to {MAX_ID_CHARACTERS} characters");
            Err(Refusal::at("request_id", "request_id_invalid", message))
        }
    }
}

impl Session {
    /// Calls a tool as [`Session::call`] does, but only once per id: a retry returns the first response. Tools that
    /// only read or run code ignore the id.
    ///
    /// # Errors
    /// The rejections of the call; `request_id_invalid`, `request_id_payload_mismatch`.
    pub fn call_once(
        &mut self,
        tool: impl AsRef<str>,
        arguments: &Value,
        via: Via,
        id: &Value,
    ) -> Result<Value, RefusalRecord> {
        let tool = tool.as_ref();
        let ignores_id = find(tool).is_some_and(|tool| !tool.spec().id.takes_request_id());
        let id = if ignores_id { &Value::Null } else { id };
        match self.sent(tool, arguments, id) {
            Err(refusal) => {
                self.record_refusal(tool, arguments, via, &refusal, None);
                Err(refusal.into())
            }
            Ok(Sent::Again(FirstAnswer::Call(Outcome::Accepted(answer)))) => Ok(answer),
            Ok(Sent::Again(FirstAnswer::Call(Outcome::Refused(refusal)))) => Err(refusal),
            Ok(Sent::Again(FirstAnswer::Week(_))) => Err(mismatch().into()),
            Ok(Sent::New(request)) => {
                let answer = self.call_recorded(tool, arguments, via, Marks { reversal: None, request })?;
                Ok(answer.to_json())
            }
        }
    }

    /// Simulates a week as [`Session::advance_given`] does, but only once per id and only on the expected day.
    ///
    /// # Errors
    /// The rejections of the week; `unexpected_day`, `request_id_invalid`, `request_id_payload_mismatch`.
    pub fn advance_once(&mut self, request: &WeekRequest<'_>, via: Via) -> Result<Week, RefusalRecord> {
        let WeekRequest { rationale, predictions, expected_day, id } = *request;
        let args = arguments_of_week(rationale, predictions, expected_day);
        let name = ToolId::NextWeek.name();
        match self.sent(name, &args, id) {
            Err(refusal) => {
                self.record_refusal(name, &args, via, &refusal, None);
                Err(refusal.into())
            }
            Ok(Sent::Again(FirstAnswer::Week(week))) => Ok(*week),
            Ok(Sent::Again(FirstAnswer::Call(Outcome::Refused(refusal)))) => Err(refusal),
            Ok(Sent::Again(FirstAnswer::Call(Outcome::Accepted(_)))) => Err(mismatch().into()),
            Ok(Sent::New(request)) => {
                let filing =
                    Filing { rationale, predictions, filled_naively: [false; 4], expected_day, request };
                Ok(self.file_week(filing, via, &mut |_| {})?)
            }
        }
    }

    /// Returns whether a request is new or a retry.
    ///
    /// # Errors
    /// `request_id_invalid`, `request_id_payload_mismatch`.
    fn sent(&self, tool: &str, args: &Value, id: &Value) -> Result<Sent, Refusal> {
        let Some(id) = id_of(id)? else { return Ok(Sent::New(None)) };
        let request = RequestId::of(id, tool, args);
        let first = self.history.first_answers.find(&request)?.cloned();
        Ok(first.map_or_else(|| Sent::New(Some(request)), Sent::Again))
    }
}
