//! Responses to requests with an id, returned again if the request is retried.
//!
//! Lines of calls and weeks contain the ids, so retries are recognized after the run is reopened. Responses to calls
//! are read from their lines. Responses to weeks contain the dashboard of their day, so snapshots store them.

use std::collections::BTreeMap;

use super::reports::Week;
use novamind_record::trajectory::record::{Call, Ended, Outcome, RequestId};
use novamind_tools::Refusal;

/// The first response to a request.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum FirstAnswer {
    Call(Outcome),
    Week(Box<Week>),
}

#[derive(Debug, Default)]
pub(crate) struct FirstAnswers {
    /// The digest of the request and its response, by id.
    by_id: BTreeMap<String, (String, FirstAnswer)>,
    /// The request whose week is being simulated.
    open: Option<RequestId>,
}

impl FirstAnswers {
    pub(crate) fn of_weeks(weeks: Vec<(RequestId, Week)>) -> FirstAnswers {
        let one = |(request, week): (RequestId, Week)| {
            (request.id, (request.digest, FirstAnswer::Week(Box::new(week))))
        };
        FirstAnswers { by_id: weeks.into_iter().map(one).collect(), open: None }
    }

    pub(crate) fn weeks(&self) -> Vec<(RequestId, Week)> {
        let week = |(id, (digest, answer)): (&String, &(String, FirstAnswer))| match answer {
            FirstAnswer::Week(week) => {
                Some((RequestId { id: id.clone(), digest: digest.clone() }, Week::clone(week)))
            }
            FirstAnswer::Call(_) => None,
        };
        self.by_id.iter().filter_map(week).collect()
    }

    /// Records the outcome of a call if its request has an id.
    pub(crate) fn note_call(&mut self, call: &Call) {
        if let Some(RequestId { id, digest }) = &call.request {
            self.by_id.insert(id.clone(), (digest.clone(), FirstAnswer::Call(call.outcome.clone())));
        }
    }

    pub(crate) fn begin_week(&mut self, request: Option<RequestId>) {
        self.open = request;
    }

    /// Records the response to the week that was simulated, if its request has an id.
    pub(crate) fn note_week(&mut self, week: impl FnOnce() -> Week) {
        if let Some(RequestId { id, digest }) = self.open.take() {
            self.by_id.insert(id, (digest, FirstAnswer::Week(Box::new(week()))));
        }
    }

    /// Adds the end of the run to the response to its last week.
    pub(crate) fn note_end(&mut self, day: u32, ended: Ended) {
        for (_, answer) in self.by_id.values_mut() {
            if let FirstAnswer::Week(week) = answer
                && week.figures.day == day
            {
                week.ended = Some(ended);
            }
        }
    }

    /// Returns the first response to a request, or `None` if the request is new.
    ///
    /// # Errors
    /// `request_id_payload_mismatch`: the id belongs to a request with other contents.
    pub(crate) fn find(&self, request: &RequestId) -> Result<Option<&FirstAnswer>, Refusal> {
        match self.by_id.get(&request.id) {
            None => Ok(None),
            Some((digest, answer)) if *digest == request.digest => Ok(Some(answer)),
            Some(_) => Err(mismatch()),
        }
    }
}

pub(crate) fn mismatch() -> Refusal {
    let message = "this request_id belongs to an earlier request of this run with other contents; nothing was \
                   changed. Use a new id for a new request";
    Refusal::at("request_id", "request_id_payload_mismatch", message)
}
