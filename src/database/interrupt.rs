//! Stopping queries: on request, when their time is over, or when they need too much of the machine.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
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

/// Names a query from the moment somebody asks for it. Whoever asks on another thread draws it first: a stop that comes
/// before the query begins then reaches it all the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Ticket(u64);

#[derive(Debug)]
struct Clockwork {
    /// Tickets that were drawn.
    drawn: AtomicU64,
    /// The newest ticket that is stopped; every older one is too.
    stopped: AtomicU64,
    /// Ticket of the query that runs, or ran last.
    running: AtomicU64,
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
            drawn: AtomicU64::new(0),
            stopped: AtomicU64::new(0),
            running: AtomicU64::new(0),
            started: Instant::now(),
            deadline: AtomicU64::new(u64::MAX),
            looks: AtomicU64::new(u64::MAX),
            memory: AtomicU64::new(u64::MAX),
            cause: AtomicU64::new(0),
        }))
    }

    /// A ticket for a query that will be asked.
    pub fn ticket(&self) -> Ticket {
        Ticket(self.0.drawn.fetch_add(1, Ordering::Relaxed) + 1)
    }

    /// Stops every query whose ticket was drawn before, whether it runs already or not.
    pub fn stop(&self) {
        self.0.stopped.fetch_max(self.0.drawn.load(Ordering::Relaxed), Ordering::Relaxed);
    }

    /// Whether what has this ticket was asked to end.
    pub fn has_stopped(&self, ticket: Ticket) -> bool {
        self.0.stopped.load(Ordering::Relaxed) >= ticket.0
    }

    /// Begins a query, or a script, with this much time and so many steps.
    pub(super) fn begin(&self, ticket: Ticket, time: Duration, steps: Option<u64>) {
        self.0.running.store(ticket.0, Ordering::Relaxed);
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
            _ if self.is_stopped() => Cause::Request,
            1 => Cause::Memory,
            _ => Cause::Time,
        }
    }

    /// Whether somebody asked the running query to end, before it began or since.
    pub(super) fn is_stopped(&self) -> bool {
        self.0.stopped.load(Ordering::Relaxed) >= self.0.running.load(Ordering::Relaxed)
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
            || self.is_stopped()
            || own.started.elapsed().as_millis() as u64 > own.deadline.load(Ordering::Relaxed)
    }
}
