//! Interrupts queries on request and when they reach a limit of time, steps or memory.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::memory::bytes_in_use;

/// Number of steps of SQLite's virtual machine between checks of time and memory. The number is small because one step
/// can process two megabytes.
pub(super) const STEPS_BETWEEN_CHECKS: u32 = 250;

/// Maximum additional memory of a query in bytes. Sorting and recursion keep their rows in memory.
const MAX_QUERY_MEMORY_BYTES: u64 = 512 << 20;

/// A handle that stops a running query at the request of another thread or at a limit.
#[derive(Debug, Clone)]
pub struct Interrupt(Arc<InterruptState>);

/// The identity of a query from its request to its end. The caller obtains the ticket before sending the query to
/// another thread. A stop request before the start of the query is therefore not lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct QueryTicket(u64);

#[derive(Debug)]
struct InterruptState {
    /// Number of issued tickets.
    issued: AtomicU64,
    /// The newest stopped ticket; all older tickets are stopped, too.
    stopped: AtomicU64,
    /// Ticket of the running or last query.
    running: AtomicU64,
    started: Instant,
    /// Deadline of the running statement, in milliseconds after `started`.
    deadline: AtomicU64,
    /// Number of checks before the running statement reaches its limit of steps.
    remaining_checks: AtomicU64,
    /// Maximum bytes that SQLite may use while the query runs.
    max_memory_bytes: AtomicU64,
    cause: AtomicU64,
}

/// The reason why a query was stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StopCause {
    /// A caller requested the stop.
    Request,
    /// The query reached its limit of time or steps.
    Time,
    /// The query reached the limit of memory.
    Memory,
}

impl Interrupt {
    pub(super) fn new() -> Interrupt {
        Interrupt(Arc::new(InterruptState {
            issued: AtomicU64::new(0),
            stopped: AtomicU64::new(0),
            running: AtomicU64::new(0),
            started: Instant::now(),
            deadline: AtomicU64::new(u64::MAX),
            remaining_checks: AtomicU64::new(u64::MAX),
            max_memory_bytes: AtomicU64::new(u64::MAX),
            cause: AtomicU64::new(0),
        }))
    }

    /// Issues a ticket for a later query.
    pub fn issue_ticket(&self) -> QueryTicket {
        QueryTicket(self.0.issued.fetch_add(1, Ordering::Relaxed) + 1)
    }

    /// Stops every query whose ticket has been issued, even if the query has not started.
    pub fn stop(&self) {
        self.0.stopped.fetch_max(self.0.issued.load(Ordering::Relaxed), Ordering::Relaxed);
    }

    /// Returns whether the query with this ticket was stopped.
    pub fn is_ticket_stopped(&self, ticket: QueryTicket) -> bool {
        self.0.stopped.load(Ordering::Relaxed) >= ticket.0
    }

    /// Resets the limits at the start of a query or script.
    pub(super) fn begin(&self, ticket: QueryTicket, time: Duration, steps: Option<u64>) {
        self.0.running.store(ticket.0, Ordering::Relaxed);
        self.0
            .max_memory_bytes
            .store(bytes_in_use().saturating_add(MAX_QUERY_MEMORY_BYTES), Ordering::Relaxed);
        self.0.cause.store(0, Ordering::Relaxed);
        self.begin_statement(time, steps);
    }

    /// Resets the limits of time and steps for the next statement of a script.
    pub(super) fn begin_statement(&self, time: Duration, steps: Option<u64>) {
        let deadline = self.0.started.elapsed() + time;
        self.0.deadline.store(deadline.as_millis() as u64, Ordering::Relaxed);
        let check_count = steps.map_or(u64::MAX, |steps| steps / u64::from(STEPS_BETWEEN_CHECKS));
        self.0.remaining_checks.store(check_count, Ordering::Relaxed);
    }

    /// Returns the reason why the query was stopped.
    pub(super) fn stop_cause(&self) -> StopCause {
        match self.0.cause.load(Ordering::Relaxed) {
            _ if self.is_stop_requested() => StopCause::Request,
            1 => StopCause::Memory,
            _ => StopCause::Time,
        }
    }

    /// Returns whether the running query was stopped on request.
    pub(super) fn is_stop_requested(&self) -> bool {
        self.0.stopped.load(Ordering::Relaxed) >= self.0.running.load(Ordering::Relaxed)
    }

    /// Returns whether the running query must end now.
    pub(super) fn should_stop(&self) -> bool {
        let interrupt_state = &self.0;
        if bytes_in_use() > interrupt_state.max_memory_bytes.load(Ordering::Relaxed) {
            interrupt_state.cause.store(1, Ordering::Relaxed);
            return true;
        }
        let check_count = interrupt_state.remaining_checks.load(Ordering::Relaxed);
        interrupt_state.remaining_checks.store(check_count.saturating_sub(1), Ordering::Relaxed);
        check_count == 0
            || self.is_stop_requested()
            || interrupt_state.started.elapsed().as_millis() as u64
                > interrupt_state.deadline.load(Ordering::Relaxed)
    }
}
