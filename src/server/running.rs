//! The request that is answered at this moment, and how the script or the statement in it is stopped.

use std::sync::{Arc, Mutex, PoisonError};

use novamind_database::Interrupt;

/// A request that is answered.
struct Held {
    number: u64,
    /// It is nothing but code: where its client has gone, nobody needs it.
    is_code: bool,
    interrupt: Interrupt,
}

/// What runs, and what stops it. A week is simulated to its end, but its calculations are stopped where the server is to end.
#[derive(Clone, Default)]
pub(super) struct Running(Arc<Mutex<Option<Held>>>);

impl Running {
    /// From now on this request runs.
    pub fn begin(&self, number: u64, is_code: bool, interrupt: Option<Interrupt>) {
        self.hold(interrupt.map(|interrupt| Held { number, is_code, interrupt }));
    }

    /// Nothing runs any more that could be stopped.
    pub fn end(&self) {
        self.hold(None);
    }

    /// Stops the script or the statement that runs.
    pub fn stop(&self) {
        self.stop_if(|_| true);
    }

    /// A watch over a request: dropped before its answer has come, it stops the request.
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
            self.running.stop_if(|held| held.is_code && held.number == self.number);
        }
    }
}
