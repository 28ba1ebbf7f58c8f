//! The script or statement that runs at this moment, and how it is stopped when nobody waits for it any more.

use std::sync::{Arc, Mutex, PoisonError};

use crate::session::Interrupt;

/// What runs: the number of its request, and what stops it. Weeks and settings are never stopped.
#[derive(Clone, Default)]
pub(super) struct Running(Arc<Mutex<Option<(u64, Interrupt)>>>);

impl Running {
    /// From now on this request runs.
    pub fn begin(&self, number: u64, interrupt: Option<Interrupt>) {
        self.hold(interrupt.map(|interrupt| (number, interrupt)));
    }

    /// Nothing runs any more that could be stopped.
    pub fn end(&self) {
        self.hold(None);
    }

    /// Stops whatever runs.
    pub fn stop(&self) {
        self.stop_if(|_| true);
    }

    /// A watch over a request: dropped before its answer has come, it stops the request.
    pub fn watch(&self, number: u64) -> Watch {
        Watch { running: self.clone(), number, is_answered: false }
    }

    fn stop_if(&self, wanted: impl Fn(u64) -> bool) {
        let held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        held.iter().filter(|(number, _)| wanted(*number)).for_each(|(_, interrupt)| interrupt.stop());
    }

    fn hold(&self, held: Option<(u64, Interrupt)>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = held;
    }
}

/// Somebody who waits for an answer.
pub(super) struct Watch {
    running: Running,
    number: u64,
    is_answered: bool,
}

impl Watch {
    /// The answer is there.
    pub fn ends(mut self) {
        self.is_answered = true;
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        if !self.is_answered {
            self.running.stop_if(|number| number == self.number);
        }
    }
}
