//! The request being executed, and how to stop its script or statement.

use std::sync::{Arc, Mutex, PoisonError};

use novamind_database::Interrupt;

/// A request being executed.
struct RunningRequest {
    number: u64,
    /// Whether it only runs code, whose result is not needed after the client has disconnected.
    is_code: bool,
    interrupt: Interrupt,
}

/// The running request and its interrupt. A week is simulated to its end, but its calculations stop when the server stops.
#[derive(Clone, Default)]
pub(super) struct CurrentRequest(Arc<Mutex<Option<RunningRequest>>>);

impl CurrentRequest {
    /// Sets the running request.
    pub fn begin(&self, number: u64, is_code: bool, interrupt: Option<Interrupt>) {
        self.set(interrupt.map(|interrupt| RunningRequest { number, is_code, interrupt }));
    }

    /// Clears the running request.
    pub fn end(&self) {
        self.set(None);
    }

    /// Stops the running script or statement.
    pub fn stop(&self) {
        self.stop_if(|_| true);
    }

    /// Returns a guard that stops the request if it is dropped before the response.
    pub fn watch(&self, number: u64) -> RequestWatch {
        RequestWatch { running: self.clone(), number, is_answered: false }
    }

    fn stop_if(&self, wanted: impl Fn(&RunningRequest) -> bool) {
        let running_request = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        running_request.iter().filter(|request| wanted(request)).for_each(|held| held.interrupt.stop());
    }

    fn set(&self, running_request: Option<RunningRequest>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = running_request;
    }
}

/// A guard of a client that waits for a response.
pub(super) struct RequestWatch {
    running: CurrentRequest,
    number: u64,
    is_answered: bool,
}

impl RequestWatch {
    /// Disarms the guard after the response.
    pub fn mark_answered(mut self) {
        self.is_answered = true;
    }
}

impl Drop for RequestWatch {
    fn drop(&mut self) {
        if !self.is_answered {
            self.running
                .stop_if(|running_request| running_request.is_code && running_request.number == self.number);
        }
    }
}
