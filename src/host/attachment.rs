//! The connection of a client to a session: its output, and the types that describe it.

use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use crate::session::HostedSession;

/// Size of a client's window in characters, within the limits of the console.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WindowSize {
    /// Number of columns, 60 to 200.
    pub columns: u16,
    /// Number of rows, 16 to 60.
    pub rows: u16,
}

impl WindowSize {
    /// Smallest window of a session.
    pub const SMALLEST: WindowSize = WindowSize { columns: 60, rows: 16 };
    /// Largest window of a session.
    pub const LARGEST: WindowSize = WindowSize { columns: 200, rows: 60 };

    /// Returns the size that is nearest to the given one and within the limits.
    pub fn clamped(columns: u16, rows: u16) -> WindowSize {
        let (smallest, largest) = (WindowSize::SMALLEST, WindowSize::LARGEST);
        WindowSize {
            columns: columns.clamp(smallest.columns, largest.columns),
            rows: rows.clamp(smallest.rows, largest.rows),
        }
    }
}

impl Default for WindowSize {
    fn default() -> WindowSize {
        WindowSize { columns: 80, rows: 24 }
    }
}

/// The program with which a participant plays.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ClientKind {
    /// A browser at this network address.
    Browser(String),
    /// `novamind host attach`, started by this account of the machine.
    Terminal(String),
}

impl fmt::Display for ClientKind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ClientKind::Browser(address) => write!(out, "browser at {address}"),
            ClientKind::Terminal(account) => write!(out, "terminal of {account}"),
        }
    }
}

/// The reason why a client cannot attach to a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AttachError {
    /// The study has no session with this label.
    UnknownLabel,
    /// The experimenter has paused the session.
    Paused,
    /// The experimenter has ended the session, with this reason.
    Ended(String),
    /// The host is shutting down.
    Shutdown,
    /// The process of the session cannot be started.
    CannotStart(String),
}

impl fmt::Display for AttachError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AttachError::UnknownLabel => {
                out.write_str("this label is not in the study: check the label, or ask the experimenter")
            }
            AttachError::Paused => out
                .write_str("the experimenter has paused this session: everything is saved; try again later"),
            AttachError::Ended(reason) if reason.is_empty() => {
                out.write_str("the experimenter has ended this session")
            }
            AttachError::Ended(reason) => write!(out, "the experimenter has ended this session: {reason}"),
            AttachError::Shutdown => {
                out.write_str("the host is shutting down: everything is saved; try again later")
            }
            AttachError::CannotStart(problem) => {
                write!(
                    out,
                    "the session cannot be started: {problem}. Everything is saved; ask the experimenter"
                )
            }
        }
    }
}

impl std::error::Error for AttachError {}

/// Output of a session to its client.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Output {
    /// Bytes for the client's terminal.
    Bytes(Vec<u8>),
    /// A message that the client shows next to the terminal.
    Notice(Notice),
    /// The session has closed the connection. Later calls return the same value.
    Closed(CloseReason),
}

/// A message that a client shows next to the terminal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Notice {
    /// A message from the experimenter.
    Experimenter(String),
    /// The process of the session ended unexpectedly and was started again.
    Restarted,
}

impl fmt::Display for Notice {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Notice::Experimenter(text) => write!(out, "Message from the experimenter: {text}"),
            Notice::Restarted => out.write_str(
                "The session stopped unexpectedly and was restarted. Everything you confirmed is saved.",
            ),
        }
    }
}

/// The reason why a session closed the connection of a client.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CloseReason {
    /// Another client attached to the session.
    TakenOver,
    /// The program of the session ended: the participant left, finished or withdrew, or the experimenter ended the session.
    Ended,
    /// The experimenter paused the session.
    Paused,
    /// The host is shutting down.
    Shutdown,
    /// The program of the session failed repeatedly.
    Failed,
}

impl fmt::Display for CloseReason {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            CloseReason::TakenOver => "This session was opened in another window, which continues it.",
            CloseReason::Ended => "The session is closed. Everything is saved.",
            CloseReason::Paused => {
                "The experimenter has paused this session. Everything is saved; connect again later."
            }
            CloseReason::Shutdown => "The host is shutting down. Everything is saved; connect again later.",
            CloseReason::Failed => {
                "The session failed repeatedly. Everything you confirmed is saved; ask the experimenter."
            }
        })
    }
}

/// A client's connection to a session. Dropping it detaches the client.
#[derive(Debug)]
pub struct Attachment {
    pub(crate) session: Arc<HostedSession>,
    pub(crate) queue: Arc<ClientQueue>,
}

impl Attachment {
    /// Waits for the next output. A client that is slow gets the current screen instead of a queue of old output.
    /// The future can be dropped without losing output.
    pub async fn next_output(&mut self) -> Output {
        loop {
            if let Some(output) = self.session.take_output(&self.queue) {
                return output;
            }
            self.queue.changed.notified().await;
        }
    }

    /// Sends input to the session. Input is discarded if another client has taken over.
    pub fn send_input(&self, bytes: &[u8]) {
        self.session.send_input(&self.queue, bytes);
    }

    /// Requests the whole screen as the next output.
    pub fn request_screen(&self) {
        self.queue.update(|pending| pending.needs_screen = true);
    }

    /// Returns the number of processes that the session has had since the host started. It changes when a process starts.
    pub fn process_number(&self) -> u64 {
        self.session.process_number()
    }

    /// Sets the size of the window.
    pub fn resize(&self, size: WindowSize) {
        self.session.resize(&self.queue, size);
    }
}

impl Drop for Attachment {
    fn drop(&mut self) {
        self.session.detach(&self.queue);
    }
}

/// Output that waits for a client.
#[derive(Debug)]
pub(crate) struct ClientQueue {
    pub kind: ClientKind,
    pending: Mutex<PendingOutput>,
    changed: Notify,
}

#[derive(Debug)]
pub(crate) struct PendingOutput {
    /// Bytes that the client has not taken yet.
    pub bytes: Vec<u8>,
    /// Whether the client needs the whole screen, because it is new or its bytes were discarded.
    pub needs_screen: bool,
    pub notices: VecDeque<Notice>,
    pub closed: Option<CloseReason>,
}

impl ClientQueue {
    /// Number of bytes that may wait for a client. More bytes are replaced by the current screen.
    const MAX_PENDING_BYTES: usize = 64 << 10;

    pub fn new(kind: ClientKind) -> ClientQueue {
        let pending =
            PendingOutput { bytes: Vec::new(), needs_screen: true, notices: VecDeque::new(), closed: None };
        ClientQueue { kind, pending: Mutex::new(pending), changed: Notify::new() }
    }

    pub fn lock(&self) -> MutexGuard<'_, PendingOutput> {
        self.pending.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the pending output and wakes the client.
    pub fn update(&self, change: impl FnOnce(&mut PendingOutput)) {
        change(&mut self.lock());
        self.changed.notify_one();
    }

    pub fn push_bytes(&self, bytes: &[u8]) {
        self.update(|pending| {
            if pending.needs_screen {
                return;
            }
            if pending.bytes.len() + bytes.len() > ClientQueue::MAX_PENDING_BYTES {
                pending.bytes.clear();
                pending.needs_screen = true;
            } else {
                pending.bytes.extend_from_slice(bytes);
            }
        });
    }

    pub fn close(&self, reason: CloseReason) {
        self.update(|pending| {
            pending.closed.get_or_insert(reason);
        });
    }
}
