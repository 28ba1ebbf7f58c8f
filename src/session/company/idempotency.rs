//! Stored responses to requests with an id. If a client retries a request, the session returns the stored response.
//!
//! Lines of calls and weeks contain the request ids, so retries are recognized after the run is reopened. Responses to
//! calls are read from the lines. Responses to weeks contain the dashboard of their day, so snapshots store these
//! responses.

use std::collections::BTreeMap;

use super::reports::WeekResult;
use novamind_record::trajectory::record::{Call, Outcome, RequestId, RunEndReason};
use novamind_tools::Rejection;

/// The stored response to a request with an id.
#[derive(Debug, Clone, PartialEq)]
pub enum IdempotentResponse {
    /// The outcome of a tool call.
    Call(Outcome),
    /// The result of a week.
    Week(Box<WeekResult>),
}

#[derive(Debug, Default)]
pub(crate) struct IdempotentResponses {
    /// Digest and response of each request, by request id.
    by_id: BTreeMap<String, (String, IdempotentResponse)>,
    /// Request for the week that is being simulated.
    pending_request: Option<RequestId>,
}

impl IdempotentResponses {
    pub(crate) fn from_weeks(weeks: Vec<(RequestId, WeekResult)>) -> IdempotentResponses {
        let one = |(request, week): (RequestId, WeekResult)| {
            (request.id, (request.digest, IdempotentResponse::Week(Box::new(week))))
        };
        IdempotentResponses { by_id: weeks.into_iter().map(one).collect(), pending_request: None }
    }

    pub(crate) fn recorded_weeks(&self) -> Vec<(RequestId, WeekResult)> {
        let week = |(id, (digest, answer)): (&String, &(String, IdempotentResponse))| match answer {
            IdempotentResponse::Week(week) => {
                Some((RequestId { id: id.clone(), digest: digest.clone() }, WeekResult::clone(week)))
            }
            IdempotentResponse::Call(_) => None,
        };
        self.by_id.iter().filter_map(week).collect()
    }

    /// Stores the outcome of a call if its request has an id.
    pub(crate) fn record_call(&mut self, call: &Call) {
        if let Some(RequestId { id, digest }) = &call.request {
            self.by_id.insert(id.clone(), (digest.clone(), IdempotentResponse::Call(call.outcome.clone())));
        }
    }

    pub(crate) fn start_week(&mut self, request: Option<RequestId>) {
        self.pending_request = request;
    }

    /// Stores the response to the request for the simulated week, if the request has an id.
    pub(crate) fn record_week(&mut self, week: impl FnOnce() -> WeekResult) {
        if let Some(RequestId { id, digest }) = self.pending_request.take() {
            self.by_id.insert(id, (digest, IdempotentResponse::Week(Box::new(week()))));
        }
    }

    /// Adds the reason for the end of the run to the response for its last week.
    pub(crate) fn record_end(&mut self, day: u32, ended: RunEndReason) {
        for (_, answer) in self.by_id.values_mut() {
            if let IdempotentResponse::Week(week) = answer
                && week.figures.day == day
            {
                week.ended = Some(ended);
            }
        }
    }

    /// Returns the stored response to the request with this id, or `None` if no request has the id.
    pub(crate) fn find_by_id(&self, id: &str) -> Option<&IdempotentResponse> {
        self.by_id.get(id).map(|(_, response)| response)
    }

    /// Returns the stored response to a request, or `None` if the request is new.
    ///
    /// # Errors
    /// `request_id_payload_mismatch`: the id belongs to a request with different contents.
    pub(crate) fn find(&self, request: &RequestId) -> Result<Option<&IdempotentResponse>, Rejection> {
        match self.by_id.get(&request.id) {
            None => Ok(None),
            Some((digest, answer)) if *digest == request.digest => Ok(Some(answer)),
            Some(_) => Err(payload_mismatch_rejection()),
        }
    }
}

pub(crate) fn payload_mismatch_rejection() -> Rejection {
    let message = "this request_id belongs to an earlier request of this run with different contents; nothing was \
         changed. Use a new id for a new request";
    Rejection::for_field("request_id", "request_id_payload_mismatch", message)
}
