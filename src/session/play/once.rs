//! Requests that carry an id run once: the first answer is kept and returned to each retry.
//!
//! The ids are in the lines of calls and weeks, so the answers are known again after the run was reopened. Answers to calls are
//! read from their lines. Answers to weeks hold the dashboard of their day, so snapshots keep them.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::act::Marks;
use super::advance::{Filing, Week};
use crate::session::state::Session;
use crate::session::trajectory::record::{Call, Ended, Outcome, RefusalRecord, RequestId, Via};
use crate::tools::{Refusal, ToolId, find};

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

/// The first answer to a request.
#[derive(Debug, Clone, PartialEq)]
enum FirstAnswer {
    Call(Outcome),
    Week(Box<Week>),
}

/// A request as the session receives it.
enum Sent {
    /// It was not answered before; the id with which it is recorded.
    New(Option<RequestId>),
    /// It was answered.
    Again(FirstAnswer),
}

/// The first answers to the requests of a run that carried an id.
#[derive(Debug, Default)]
pub(in crate::session) struct FirstAnswers {
    /// By id, with the digest of the request.
    by_id: BTreeMap<String, (String, FirstAnswer)>,
    /// The request of the week that is being simulated.
    open: Option<RequestId>,
}

impl FirstAnswers {
    /// Restores the answers to weeks of a snapshot.
    pub(in crate::session) fn of_weeks(weeks: Vec<(RequestId, Week)>) -> FirstAnswers {
        let one = |(request, week): (RequestId, Week)| {
            (request.id, (request.digest, FirstAnswer::Week(Box::new(week))))
        };
        FirstAnswers { by_id: weeks.into_iter().map(one).collect(), open: None }
    }

    /// Returns the answers to weeks, for a snapshot.
    pub(in crate::session) fn weeks(&self) -> Vec<(RequestId, Week)> {
        let week = |(id, (digest, answer)): (&String, &(String, FirstAnswer))| match answer {
            FirstAnswer::Week(week) => {
                Some((RequestId { id: id.clone(), digest: digest.clone() }, Week::clone(week)))
            }
            FirstAnswer::Call(_) => None,
        };
        self.by_id.iter().filter_map(week).collect()
    }

    /// Keeps the outcome of a call that carries an id.
    pub(in crate::session) fn note_call(&mut self, call: &Call) {
        if let Some(RequestId { id, digest }) = &call.request {
            self.by_id.insert(id.clone(), (digest.clone(), FirstAnswer::Call(call.outcome.clone())));
        }
    }

    /// Begins the week of a request.
    pub(in crate::session) fn begin_week(&mut self, request: Option<RequestId>) {
        self.open = request;
    }

    /// Keeps the answer to the request whose week has passed, if one is open.
    pub(in crate::session) fn note_week(&mut self, week: impl FnOnce() -> Week) {
        if let Some(RequestId { id, digest }) = self.open.take() {
            self.by_id.insert(id, (digest, FirstAnswer::Week(Box::new(week()))));
        }
    }

    /// Adds the end of the run to the answer to its last week.
    pub(in crate::session) fn note_end(&mut self, day: u32, ended: Ended) {
        for (_, answer) in self.by_id.values_mut() {
            if let FirstAnswer::Week(week) = answer
                && week.figures.day == day
            {
                week.ended = Some(ended);
            }
        }
    }

    /// Returns the first answer to a request, or `None` if it is new.
    ///
    /// # Errors
    /// `request_id_payload_mismatch`: the id belongs to a request that asked something else.
    fn find(&self, request: &RequestId) -> Result<Option<&FirstAnswer>, Refusal> {
        match self.by_id.get(&request.id) {
            None => Ok(None),
            Some((digest, answer)) if *digest == request.digest => Ok(Some(answer)),
            Some(_) => Err(mismatch()),
        }
    }
}

fn mismatch() -> Refusal {
    let message = "this request_id belongs to an earlier request of this run that asked something else; nothing was \
                   changed. A new request needs a new id";
    Refusal::at("request_id", "request_id_payload_mismatch", message)
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

/// The arguments of a week as its refusal records them.
pub(in crate::session) fn arguments_of_week(
    rationale: &Value,
    predictions: &Value,
    expected_day: &Value,
) -> Value {
    let mut args = json!({ "rationale": rationale, "predictions": predictions });
    if !expected_day.is_null() {
        args["expected_day"] = expected_day.clone();
    }
    args
}
