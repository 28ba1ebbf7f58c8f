//! Stopping queries: on request, when their time is over, or when they need too much of the machine.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::memory::bytes_in_use;

/// Steps of SQLite's machine between two looks at clock and memory: few, for each may take a value of two megabytes.
pub(super) const STEPS_BETWEEN_LOOKS: u32 = 250;

/// Memory that SQLite may take for a query beyond what it had before, in bytes: sorting and recursion keep their
/// rows in memory.
const MOST_MEMORY: u64 = 512 << 20;

/// Stops a running query from another thread, or by itself when its time is over.
#[derive(Debug, Clone)]
pub struct Interrupt(Arc<Clockwork>);

#[derive(Debug)]
struct Clockwork {
    stopped: AtomicBool,
    started: Instant,
    /// Milliseconds after `started` at which the running query has to end.
    deadline: AtomicU64,
    /// Looks that are left to the running query.
    looks: AtomicU64,
    /// Bytes that may be in use while it runs.
    memory: AtomicU64,
    cause: AtomicU64,
}

/// Why a query was stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cause {
    /// Somebody asked for it.
    Request,
    /// Its time, or its number of steps, was over.
    Time,
    /// It took too much memory.
    Memory,
}

impl Interrupt {
    pub(super) fn new() -> Interrupt {
        Interrupt(Arc::new(Clockwork {
            stopped: AtomicBool::new(false),
            started: Instant::now(),
            deadline: AtomicU64::new(u64::MAX),
            looks: AtomicU64::new(u64::MAX),
            memory: AtomicU64::new(u64::MAX),
            cause: AtomicU64::new(0),
        }))
    }

    /// Stops the query that is running, if one is.
    pub fn stop(&self) {
        self.0.stopped.store(true, Ordering::Relaxed);
    }

    /// Begins a query, or a script, with this much time and so many steps.
    pub(super) fn begin(&self, time: Duration, steps: Option<u64>) {
        self.0.stopped.store(false, Ordering::Relaxed);
        self.0.memory.store(bytes_in_use().saturating_add(MOST_MEMORY), Ordering::Relaxed);
        self.0.cause.store(0, Ordering::Relaxed);
        self.go_on(time, steps);
    }

    /// Begins the next statement of a script.
    pub(super) fn go_on(&self, time: Duration, steps: Option<u64>) {
        let deadline = self.0.started.elapsed() + time;
        self.0.deadline.store(deadline.as_millis() as u64, Ordering::Relaxed);
        let looks = steps.map_or(u64::MAX, |steps| steps / u64::from(STEPS_BETWEEN_LOOKS));
        self.0.looks.store(looks, Ordering::Relaxed);
    }

    /// Why the query was stopped.
    pub(super) fn cause(&self) -> Cause {
        match self.0.cause.load(Ordering::Relaxed) {
            _ if self.0.stopped.load(Ordering::Relaxed) => Cause::Request,
            1 => Cause::Memory,
            _ => Cause::Time,
        }
    }

    /// Whether the running query has to end now.
    pub(super) fn must_end(&self) -> bool {
        let own = &self.0;
        if bytes_in_use() > own.memory.load(Ordering::Relaxed) {
            own.cause.store(1, Ordering::Relaxed);
            return true;
        }
        let looks = own.looks.load(Ordering::Relaxed);
        own.looks.store(looks.saturating_sub(1), Ordering::Relaxed);
        looks == 0
            || own.stopped.load(Ordering::Relaxed)
            || own.started.elapsed().as_millis() as u64 > own.deadline.load(Ordering::Relaxed)
    }
}
