//! First answers to requests that carried an id.
//!
//! The ids are in the lines of calls and weeks, so the answers are known again after the run was reopened. Answers to calls are
//! read from their lines. Answers to weeks hold the dashboard of their day, so snapshots keep them.

use std::collections::BTreeMap;

use super::reports::Week;
use novamind_record::trajectory::record::{Call, Ended, Outcome, RequestId};
use novamind_tools::Refusal;

/// The first answer to a request.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum FirstAnswer {
    Call(Outcome),
    Week(Box<Week>),
}

/// The first answers to the requests of a run that carried an id.
#[derive(Debug, Default)]
pub(crate) struct FirstAnswers {
    /// By id, with the digest of the request.
    by_id: BTreeMap<String, (String, FirstAnswer)>,
    /// The request of the week that is being simulated.
    open: Option<RequestId>,
}

impl FirstAnswers {
    /// Restores the answers to weeks of a snapshot.
    pub(crate) fn of_weeks(weeks: Vec<(RequestId, Week)>) -> FirstAnswers {
        let one = |(request, week): (RequestId, Week)| {
            (request.id, (request.digest, FirstAnswer::Week(Box::new(week))))
        };
        FirstAnswers { by_id: weeks.into_iter().map(one).collect(), open: None }
    }

    /// Returns the answers to weeks, for a snapshot.
    pub(crate) fn weeks(&self) -> Vec<(RequestId, Week)> {
        let week = |(id, (digest, answer)): (&String, &(String, FirstAnswer))| match answer {
            FirstAnswer::Week(week) => {
                Some((RequestId { id: id.clone(), digest: digest.clone() }, Week::clone(week)))
            }
            FirstAnswer::Call(_) => None,
        };
        self.by_id.iter().filter_map(week).collect()
    }

    /// Keeps the outcome of a call that carries an id.
    pub(crate) fn note_call(&mut self, call: &Call) {
        if let Some(RequestId { id, digest }) = &call.request {
            self.by_id.insert(id.clone(), (digest.clone(), FirstAnswer::Call(call.outcome.clone())));
        }
    }

    /// Begins the week of a request.
    pub(crate) fn begin_week(&mut self, request: Option<RequestId>) {
        self.open = request;
    }

    /// Keeps the answer to the request whose week has passed, if one is open.
    pub(crate) fn note_week(&mut self, week: impl FnOnce() -> Week) {
        if let Some(RequestId { id, digest }) = self.open.take() {
            self.by_id.insert(id, (digest, FirstAnswer::Week(Box::new(week()))));
        }
    }

    /// Adds the end of the run to the answer to its last week.
    pub(crate) fn note_end(&mut self, day: u32, ended: Ended) {
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
    pub(crate) fn find(&self, request: &RequestId) -> Result<Option<&FirstAnswer>, Refusal> {
        match self.by_id.get(&request.id) {
            None => Ok(None),
            Some((digest, answer)) if *digest == request.digest => Ok(Some(answer)),
            Some(_) => Err(mismatch()),
        }
    }
}

/// The refusal of a request whose id belongs to another one.
pub(crate) fn mismatch() -> Refusal {
    let message = "this request_id belongs to an earlier request of this run that asked something else; nothing was \
                   changed. A new request needs a new id";
    Refusal::at("request_id", "request_id_payload_mismatch", message)
}
