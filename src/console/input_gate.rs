//! A gate for the thread that reads keys. While the user's editor is open, the gate is closed, so that the editor
//! receives the keys.

#[cfg(unix)]
use std::io;
use std::sync::{Condvar, Mutex, MutexGuard};
#[cfg(unix)]
use std::time::Duration;

/// Time after which the thread that reads keys is woken again.
#[cfg(unix)]
const WAKE_INTERVAL: Duration = Duration::from_millis(50);
/// Maximum number of times that the thread that reads keys is woken.
#[cfg(unix)]
const MAX_WAKES: u32 = 40;

/// A gate that pauses the thread that reads keys, so that another program receives the keys.
#[derive(Default)]
pub struct InputGate {
    state: Mutex<GateState>,
    changed: Condvar,
}

#[derive(Default, Clone, Copy, PartialEq, Eq)]
enum GateState {
    /// Keys are read.
    #[default]
    Open,
    /// The thread that reads keys must pause.
    Closing,
    /// The thread has paused.
    Closed,
}

impl InputGate {
    fn lock(&self) -> MutexGuard<'_, GateState> {
        self.state.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Pauses the calling thread while the gate is closed. The thread calls this between two reads.
    pub fn pass(&self) {
        let mut state = self.lock();
        while *state != GateState::Open {
            *state = GateState::Closed;
            self.changed.notify_all();
            state = self.changed.wait(state).unwrap_or_else(|poisoned| poisoned.into_inner());
        }
    }

    /// Returns whether another program receives the keys, or is about to.
    pub fn is_closed(&self) -> bool {
        *self.lock() != GateState::Open
    }

    /// Closes the gate and waits until the thread that reads keys has paused. `wake` interrupts its read.
    ///
    /// # Errors
    /// The thread does not pause.
    #[cfg(unix)]
    pub fn close(&self, wake: impl Fn()) -> io::Result<()> {
        *self.lock() = GateState::Closing;
        for _ in 0..MAX_WAKES {
            wake();
            let state = self.lock();
            let wait =
                self.changed.wait_timeout_while(state, WAKE_INTERVAL, |state| *state != GateState::Closed);
            if *wait.unwrap_or_else(|poisoned| poisoned.into_inner()).0 == GateState::Closed {
                return Ok(());
            }
        }
        self.open();
        Err(io::Error::other("the console still reads the keys"))
    }

    /// Opens the gate.
    pub fn open(&self) {
        *self.lock() = GateState::Open;
        self.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::mpsc::channel;

    #[test]
    fn gate_pauses_the_reading_thread_until_it_opens() {
        let gate = Arc::new(InputGate::default());
        let (events, read) = channel::<u8>();
        let (passed, seen) = channel();
        let thread = {
            let gate = gate.clone();
            std::thread::spawn(move || {
                loop {
                    gate.pass();
                    match read.recv() {
                        Ok(event) if passed.send(event).is_ok() => {}
                        _ => return,
                    }
                }
            })
        };
        gate.close(|| events.send(0).expect("a reader")).expect("the gate closes");
        assert!(gate.is_closed());
        while seen.try_recv().is_ok() {}
        events.send(7).expect("a reader");
        gate.open();
        assert!(seen.iter().any(|event| event == 7), "keys after the editor are read");
        drop(events);
        thread.join().expect("the thread ends");
    }
}
