//! Requests that carry an id run once: the first answer is kept and returned to each retry.

use serde_json::Value;

use super::Session;
use super::act::Marks;
use super::advance::{Filing, arguments_of_week};
use crate::company::first_answers::{FirstAnswer, mismatch};
use crate::company::reports::Week;
use novamind_record::trajectory::record::{Outcome, RefusalRecord, RequestId, Via};
use novamind_tools::{Refusal, ToolId, find};

/// Longest id, in characters.
const MAX_ID_CHARACTERS: usize = 128;

/// A request to let a week pass, as a program sends it.
#[derive(Debug, Clone, Copy)]
pub struct WeekRequest<'a> {
    /// Why.
    pub rationale: &'a Value,
    /// Forecasts of four horizons.
    pub predictions: &'a Value,
    /// The day on which the run must be; null if any will do.
    pub expected_day: &'a Value,
    /// The id of the request; null without one.
    pub id: &'a Value,
}

/// A request as the session receives it.
enum Sent {
    /// It was not answered before; the id with which it is recorded.
    New(Option<RequestId>),
    /// It was answered.
    Again(FirstAnswer),
}

/// Reads the id of a request.
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
    /// Calls a tool as [`Session::call`] does, once for each id: a retry returns the first answer. Tools that only read or run
    /// code ignore the id.
    ///
    /// # Errors
    /// The refusals of the call; `request_id_invalid`, `request_id_payload_mismatch`.
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

    /// Lets a week pass as [`Session::advance_given`] does, once for each id, and only on the expected day.
    ///
    /// # Errors
    /// The refusals of the week; `unexpected_day`, `request_id_invalid`, `request_id_payload_mismatch`.
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

    /// Tells a new request from one that was answered.
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
