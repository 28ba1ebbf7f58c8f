//! The request being executed, and how to stop its script or statement.

use std::sync::{Arc, Mutex, PoisonError};

use novamind_database::Interrupt;

/// A request being executed.
struct Held {
    number: u64,
    /// Whether it only runs code, whose result nobody needs after the client has gone.
    is_code: bool,
    interrupt: Interrupt,
}

/// The running request and its interrupt. A week is simulated to its end, but its calculations stop when the server stops.
#[derive(Clone, Default)]
pub(super) struct Running(Arc<Mutex<Option<Held>>>);

impl Running {
    /// Sets the running request.
    pub fn begin(&self, number: u64, is_code: bool, interrupt: Option<Interrupt>) {
        self.hold(interrupt.map(|interrupt| Held { number, is_code, interrupt }));
    }

    /// Clears the running request.
    pub fn end(&self) {
        self.hold(None);
    }

    /// Stops the running script or statement.
    pub fn stop(&self) {
        self.stop_if(|_| true);
    }

    /// Returns a guard that stops the request if it is dropped before the response.
    pub fn watch(&self, number: u64) -> Watch {
        Watch { running: self.clone(), number, is_answered: false }
    }

    fn stop_if(&self, wanted: impl Fn(&Held) -> bool) {
        let held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        held.iter().filter(|held| wanted(held)).for_each(|held| held.interrupt.stop());
    }

    fn hold(&self, held: Option<Held>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = held;
    }
}

/// A guard of a client that waits for a response.
pub(super) struct Watch {
    running: Running,
    number: u64,
    is_answered: bool,
}

impl Watch {
    /// Disarms the guard after the response.
    pub fn ends(mut self) {
        self.is_answered = true;
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        if !self.is_answered {
            self.running.stop_if(|held| held.is_code && held.number == self.number);
        }
    }
}
