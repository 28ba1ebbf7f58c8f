//! The request that is being executed, and the interrupt that stops its script or statement.

use std::sync::{Arc, Mutex, PoisonError};

use novamind_database::Interrupt;

/// A request that is being executed and can be interrupted.
struct RunningRequest {
    number: u64,
    /// Whether the request only runs a script or statement, so that its result is not needed after the client has
    /// disconnected.
    is_code: bool,
    interrupt: Interrupt,
}

/// The running request and its interrupt. If the server shuts down during a week, the simulation of the week continues
/// to its end, but the calculations of the week are stopped.
#[derive(Clone, Default)]
pub(super) struct CurrentRequest(Arc<Mutex<Option<RunningRequest>>>);

impl CurrentRequest {
    /// Records the start of a request.
    pub fn begin(&self, number: u64, is_code: bool, interrupt: Option<Interrupt>) {
        self.set(interrupt.map(|interrupt| RunningRequest { number, is_code, interrupt }));
    }

    /// Records the end of the running request.
    pub fn end(&self) {
        self.set(None);
    }

    /// Stops the running script or statement.
    pub fn stop(&self) {
        self.stop_if(|_| true);
    }

    /// Returns a guard that stops the request when it is dropped, unless the response was received first.
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

/// A guard that stops a request if the client no longer waits for its response.
pub(super) struct RequestWatch {
    running: CurrentRequest,
    number: u64,
    is_answered: bool,
}

impl RequestWatch {
    /// Disarms the guard after the response was received.
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
