//! Handles ctrl-c and termination signals. A signal cancels a query or a what-if simulation and ends a prompt
//! immediately. A running week is first simulated to its end.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

use novamind_database::Interrupt;

/// The current activity of plain mode, which determines the effect of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Plain mode waits for a line.
    Prompt,
    /// Plain mode executes a command that ends soon and cannot be stopped.
    Working,
    /// Plain mode queries the database.
    Query,
    /// Plain mode runs a simulation that can be stopped.
    Simulation,
}

/// Handle of the thread that watches for signals.
#[derive(Clone)]
pub struct SignalWatch(Arc<Mutex<WatchState>>);

struct WatchState {
    phase: Phase,
    interrupt: Option<Interrupt>,
    /// Flag that stops the running simulation.
    stop: Arc<AtomicBool>,
    caught: Option<i32>,
    /// Whether a signal that ends the wait at the prompt was received.
    leaving: bool,
}

impl SignalWatch {
    /// Starts to watch for signals. `prompt` is called for signals at a prompt. If signals cannot be watched,
    /// a signal ends the program immediately, and no confirmed data is lost.
    pub fn start(prompt: impl Fn(i32) + Send + 'static) -> SignalWatch {
        let state = WatchState {
            phase: Phase::Working,
            interrupt: None,
            stop: Arc::default(),
            caught: None,
            leaving: false,
        };
        let watch = SignalWatch(Arc::new(Mutex::new(state)));
        #[cfg(unix)]
        watch.spawn_listener(prompt);
        #[cfg(not(unix))]
        drop(prompt);
        watch
    }

    #[cfg(unix)]
    fn spawn_listener(&self, prompt: impl Fn(i32) + Send + 'static) {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP]) else { return };
        let watch = self.clone();
        std::thread::spawn(move || {
            for signal in signals.forever() {
                watch.handle_signal(signal, signal == SIGINT, &prompt);
            }
        });
    }

    #[cfg(unix)]
    fn handle_signal(&self, signal: i32, by_key: bool, prompt: &impl Fn(i32)) {
        let mut state = self.lock_state();
        if state.leaving {
            // A second signal ends the program. Only the last line can be lost; all confirmed actions are already written.
            std::process::exit(128 + signal);
        }
        if state.phase == Phase::Prompt {
            state.leaving = true;
            prompt(signal);
            return;
        }
        if let (Phase::Query, Some(interrupt)) = (state.phase, &state.interrupt) {
            interrupt.stop();
            if by_key {
                return;
            }
        }
        if state.phase == Phase::Simulation {
            state.stop.store(true, Ordering::Relaxed);
            if by_key {
                return;
            }
        }
        state.caught = Some(signal);
    }

    /// Sets the current activity of plain mode.
    pub fn set_phase(&self, phase: Phase) {
        self.lock_state().phase = phase;
    }

    /// Sets the activity to waiting for a line. Returns `false` if a signal has already arrived, because this
    /// signal would not end the wait.
    pub fn enter_prompt(&self) -> bool {
        let mut state = self.lock_state();
        let waits = state.caught.is_none();
        if waits {
            state.phase = Phase::Prompt;
        }
        waits
    }

    /// Sets the activity to a query. A signal stops the query through `interrupt`.
    pub fn enter_query(&self, interrupt: Interrupt) {
        let mut state = self.lock_state();
        (state.phase, state.interrupt) = (Phase::Query, Some(interrupt));
    }

    /// Sets the activity to a simulation. The returned flag becomes true when the simulation must stop.
    pub fn enter_simulation(&self) -> Arc<AtomicBool> {
        let mut state = self.lock_state();
        (state.phase, state.stop) = (Phase::Simulation, Arc::default());
        state.stop.clone()
    }

    /// Records a signal that ended the wait at a prompt.
    pub fn record_signal(&self, signal: i32) {
        self.lock_state().caught = Some(signal);
    }

    /// Returns the signal that ends the session, if a signal was received.
    pub fn caught_signal(&self) -> Option<i32> {
        self.lock_state().caught
    }

    fn lock_state(&self) -> MutexGuard<'_, WatchState> {
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

#[cfg(test)]
mod tests {
    #[cfg(unix)]
    use super::*;

    #[cfg(unix)]
    #[test]
    fn signal_before_the_prompt_is_not_lost() {
        let watch = SignalWatch::start(|_| panic!("no prompt is waiting"));
        watch.handle_signal(15, false, &|_| panic!("no prompt is waiting"));
        assert!(!watch.enter_prompt());
        assert_eq!(watch.caught_signal(), Some(15));
    }
}
