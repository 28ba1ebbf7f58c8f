//! Ctrl-c and termination: a query is cancelled, a week is waited for, a prompt is left at once.

use std::sync::{Arc, Mutex, MutexGuard};

use crate::session::Interrupt;

/// What the dialogue is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Waiting for a line.
    Prompt,
    /// Working on something that ends by itself.
    Working,
    /// Asking the database.
    Query,
}

/// Watches for signals.
#[derive(Clone)]
pub struct Watch(Arc<Mutex<State>>);

struct State {
    phase: Phase,
    /// What to print when the prompt is left.
    farewell: String,
    interrupt: Option<Interrupt>,
    caught: Option<i32>,
}

impl Watch {
    /// Starts watching. Where signals cannot be watched they end the program as ever; nothing is lost by it.
    pub fn start() -> Watch {
        let state = State { phase: Phase::Working, farewell: String::new(), interrupt: None, caught: None };
        let watch = Watch(Arc::new(Mutex::new(state)));
        #[cfg(unix)]
        watch.listen();
        watch
    }

    #[cfg(unix)]
    fn listen(&self) {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP]) else { return };
        let watch = self.clone();
        std::thread::spawn(move || {
            for signal in signals.forever() {
                watch.handle(signal, signal == SIGINT);
            }
        });
    }

    #[cfg(unix)]
    fn handle(&self, signal: i32, by_key: bool) {
        let mut state = self.state();
        if state.phase == Phase::Prompt {
            // Everything confirmed is on the disk; the prompt has nothing to finish.
            println!("{}", state.farewell);
            std::process::exit(128 + signal);
        }
        if let (Phase::Query, Some(interrupt)) = (state.phase, &state.interrupt) {
            interrupt.stop();
            if by_key {
                return;
            }
        }
        state.caught = Some(signal);
    }

    /// Says what the dialogue is doing now.
    pub fn enter(&self, phase: Phase, farewell: String) {
        let mut state = self.state();
        (state.phase, state.farewell) = (phase, farewell);
    }

    /// Says that a query is asked, which this stops.
    pub fn enter_query(&self, interrupt: Interrupt) {
        let mut state = self.state();
        (state.phase, state.interrupt) = (Phase::Query, Some(interrupt));
    }

    /// The signal that asked to leave, if one did.
    pub fn caught(&self) -> Option<i32> {
        self.state().caught
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}
