//! The state after the last executed request. A server of release 2 reports this state even while a week is simulated.

use std::sync::{Arc, Mutex, PoisonError};

use serde_json::{Value, json};

use super::request::ApiResponse;
use super::request_handler::game_status;
use novamind_record::clock::{now, parse_seconds};
use novamind_session::Session;

/// The state of a run after the last executed request. Readers do not wait for the session.
#[derive(Clone)]
pub struct CommittedState(Arc<Mutex<State>>);

struct State {
    /// Fields of `/game-status`, except `busy`.
    status: Value,
    /// Dashboard of the last week; empty before the first week.
    dashboard: String,
    /// ID of the request that is being executed.
    running: Option<String>,
}

impl State {
    fn from_session(session: &Session) -> State {
        let mut state = State { status: Value::Null, dashboard: String::new(), running: None };
        state.update(session);
        state
    }

    /// Replaces the state. The dashboard is rendered only once a week.
    fn update(&mut self, session: &Session) {
        let mut status = game_status(session).body;
        status["snapshot_at"] = json!(parse_seconds(&now()));
        if session.day() != 0 && status["day"] != self.status["day"] {
            self.dashboard = session.company().dashboard();
        }
        (self.status, self.running) = (status, None);
    }
}

impl CommittedState {
    /// Returns the current state of a run.
    pub fn new(session: &Session) -> CommittedState {
        CommittedState(Arc::new(Mutex::new(State::from_session(session))))
    }

    /// Records the start of a request that can change the run.
    pub fn begin(&self, id: &str) {
        self.access(|state| state.running = Some(id.to_owned()));
    }

    /// Replaces the state after a request. Keeps the earlier state if `session` is `None`, which it is after an
    /// internal error.
    pub fn commit(&self, session: Option<&Session>) {
        self.access(|state| match session {
            Some(session) => state.update(session),
            None => state.running = None,
        });
    }

    /// Returns whether the request with this id is being executed.
    pub fn is_running(&self, id: &str) -> bool {
        self.access(|state| state.running.as_deref() == Some(id))
    }

    /// Returns the response of `/vars`.
    pub fn variables(&self) -> ApiResponse {
        self.access(|state| ApiResponse::with_body(json!({ "current_day": state.status["day"] })))
    }

    /// Returns the response of `/dashboard`.
    pub fn dashboard(&self) -> ApiResponse {
        self.access(|state| {
            ApiResponse::with_body(json!({ "dashboard": state.dashboard, "day": state.status["day"] }))
        })
    }

    /// Returns the response of `/game-status`.
    pub fn game_status(&self) -> ApiResponse {
        self.access(|state| {
            let mut status = state.status.clone();
            status["busy"] = state.running.is_some().into();
            ApiResponse::with_body(status)
        })
    }

    fn access<T>(&self, read: impl FnOnce(&mut State) -> T) -> T {
        read(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
