//! One hosted session: its process, its screen and its client.

use std::ffi::OsString;
use std::num::NonZero;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rustix::process::Signal;
use tokio::sync::{Notify, mpsc};
use tokio::time::timeout;

use crate::attachment::{
    AttachError, Attachment, ClientKind, ClientQueue, CloseReason, Notice, Output, WindowSize,
};
use crate::audit::{AuditEvent, AuditLog};
use crate::process::{SessionProgram, StartedProcess, Terminal, send_signal};

/// Time that a process may take to save and end before it is killed.
const SAVE_TIMEOUT: Duration = Duration::from_secs(15);
/// Number of restarts after unexpected ends within [`RESTART_PERIOD`]. After more, the client has to connect again.
const MAX_RESTARTS: usize = 5;
const RESTART_PERIOD: Duration = Duration::from_secs(60);

/// Asks a terminal to report its focus. The console, which uses the alternate screen, measures attention with these reports,
/// and the parser of the screen does not store this mode.
const REPORT_FOCUS: &[u8] = b"\x1b[?1004h";

/// A session of the host. The process runs only while a participant is connected, and for a short time after that.
#[derive(Debug)]
pub(crate) struct HostedSession {
    pub label: String,
    /// Folder of the session: study, runs, temporary files.
    folder: PathBuf,
    program: SessionProgram,
    audit: AuditLog,
    /// Held while the process is started or stopped.
    lifecycle: tokio::sync::Mutex<()>,
    state: Mutex<State>,
    /// Wakes tasks that wait for the end of the process.
    process_ended: Notify,
}

struct State {
    screen: vt100::Parser,
    size: WindowSize,
    process: Option<RunningProcess>,
    client: Option<Arc<ClientQueue>>,
    /// Increases whenever a client attaches or detaches.
    client_changes: u64,
    connected_at: Option<Instant>,
    last_input: Option<Instant>,
    /// Number of processes that were started.
    process_number: u64,
    /// Times of restarts after unexpected ends.
    restarts: Vec<Instant>,
}

impl std::fmt::Debug for State {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.debug_struct("State").field("client", &self.client).finish_non_exhaustive()
    }
}

struct RunningProcess {
    id: u32,
    terminal: Terminal,
    input: mpsc::Sender<Vec<u8>>,
    /// The reason for which the host is ending the process.
    closing: Option<CloseReason>,
}

/// The connection and activity of a session's client.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Activity {
    pub client: Option<ClientKind>,
    pub is_running: bool,
    pub connected_for: Option<Duration>,
    pub idle_for: Option<Duration>,
}

impl HostedSession {
    pub fn new(label: String, folder: PathBuf, program: SessionProgram, audit: AuditLog) -> HostedSession {
        let size = WindowSize::default();
        let state = State {
            screen: blank_screen(size),
            size,
            process: None,
            client: None,
            client_changes: 0,
            connected_at: None,
            last_input: None,
            process_number: 0,
            restarts: Vec::new(),
        };
        HostedSession {
            label,
            folder,
            program,
            audit,
            lifecycle: tokio::sync::Mutex::new(()),
            state: Mutex::new(state),
            process_ended: Notify::new(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Attaches a client, closes the connection of an earlier client, and starts the process if it is not running.
    pub async fn attach(
        self: &Arc<Self>,
        kind: ClientKind,
        size: WindowSize,
    ) -> Result<Attachment, AttachError> {
        let _guard = self.lifecycle.lock().await;
        // A process that is saving must end before the next one can open the run.
        if self.lock().process.as_ref().is_some_and(|process| process.closing.is_some()) {
            self.wait_for_end().await;
        }
        let attached = AuditEvent::Attached { label: self.label.clone(), client: kind.to_string() };
        self.audit.append(&attached).map_err(|error| AttachError::CannotStart(error.to_string()))?;
        let queue = Arc::new(ClientQueue::new(kind));
        {
            let mut state = self.lock();
            if let Some(earlier) = state.client.replace(queue.clone()) {
                earlier.close(CloseReason::TakenOver);
            }
            state.client_changes += 1;
            state.connected_at = Some(Instant::now());
            state.set_size(size);
            if state.process.is_none() {
                state.screen = blank_screen(size);
                let started = self.start_process(size).map_err(|error| {
                    state.client = None;
                    AttachError::CannotStart(error.to_string())
                })?;
                self.adopt_process(&mut state, started);
            }
        }
        Ok(Attachment { session: self.clone(), queue })
    }

    fn start_process(&self, size: WindowSize) -> std::io::Result<StartedProcess> {
        let arguments =
            [OsString::from(&self.label), OsString::from("--folder"), self.folder.clone().into_os_string()];
        let temporary = self.folder.join("tmp");
        let environment: Vec<(OsString, OsString)> = [
            ("TERM", OsString::from("xterm-256color")),
            ("COLORTERM", OsString::from("truecolor")),
            ("LANG", OsString::from("C.UTF-8")),
            ("PATH", OsString::from("/usr/bin:/bin")),
            ("HOME", temporary.clone().into_os_string()),
            ("TMPDIR", temporary.clone().into_os_string()),
            ("NOVAMIND_CONFIG", temporary.join("config").into_os_string()),
            ("NOVAMIND_RUNS", self.folder.join("runs").into_os_string()),
        ]
        .map(|(name, value)| (OsString::from(name), value))
        .to_vec();
        self.program.start(&arguments, &environment, size)
    }

    fn adopt_process(self: &Arc<Self>, state: &mut State, started: StartedProcess) {
        self.record(&AuditEvent::ProcessStarted { label: self.label.clone() });
        state.process_number += 1;
        let StartedProcess { mut child, terminal } = started;
        let (input, mut inputs) = mpsc::channel::<Vec<u8>>(1024);
        let id = child.id().unwrap_or_default();
        state.process = Some(RunningProcess { id, terminal: terminal.clone(), input, closing: None });
        let writer = terminal.clone();
        tokio::spawn(async move {
            while let Some(bytes) = inputs.recv().await {
                if writer.write_all(&bytes).await.is_err() {
                    return;
                }
            }
        });
        let session = self.clone();
        tokio::spawn(async move {
            let mut buffer = vec![0; 16 << 10];
            let status = loop {
                tokio::select! {
                    biased;
                    read = terminal.read(&mut buffer) => match read {
                        Ok(count) if count > 0 => session.receive_output(&buffer[..count]),
                        _ => break child.wait().await,
                    },
                    status = child.wait() => break status,
                }
            };
            let text = status.as_ref().map_or_else(ToString::to_string, ToString::to_string);
            session.record(&AuditEvent::ProcessEnded { label: session.label.clone(), status: text });
            session.process_ended(status.is_ok_and(|status| status.success()));
        });
    }

    fn receive_output(&self, bytes: &[u8]) {
        let mut state = self.lock();
        state.screen.process(bytes);
        if let Some(client) = &state.client {
            client.push_bytes(bytes);
        }
    }

    /// Handles the end of the process. Restarts a process that failed while a client is connected.
    fn process_ended(self: &Arc<Self>, is_success: bool) {
        let mut state = self.lock();
        let Some(process) = state.process.take() else { return };
        state.restarts.retain(|at| at.elapsed() < RESTART_PERIOD);
        let has_failed = process.closing.is_none() && !is_success;
        if has_failed && state.client.is_some() && state.restarts.len() < MAX_RESTARTS {
            state.restarts.push(Instant::now());
            let size = state.size;
            state.screen = blank_screen(size);
            if let Ok(started) = self.start_process(size) {
                self.adopt_process(&mut state, started);
                if let Some(client) = &state.client {
                    client.update(|pending| {
                        pending.bytes.clear();
                        pending.needs_screen = true;
                        pending.notices.push_back(Notice::Restarted);
                    });
                }
                return;
            }
        }
        let reason =
            process.closing.unwrap_or(if is_success { CloseReason::Ended } else { CloseReason::Failed });
        if let Some(client) = state.client.take() {
            client.close(reason);
            state.client_changes += 1;
            state.connected_at = None;
        }
        drop(state);
        self.process_ended.notify_waiters();
    }

    /// Returns the next output for a client, or `None` if there is none.
    pub fn take_output(&self, queue: &ClientQueue) -> Option<Output> {
        // The state is locked first, as in `receive_output`, so that the screen and the bytes after it fit together.
        let state = self.lock();
        let mut pending = queue.lock();
        let is_current = state.client.as_ref().is_some_and(|client| std::ptr::eq(&**client, queue));
        if pending.needs_screen && is_current {
            pending.needs_screen = false;
            pending.bytes.clear();
            let screen = state.screen.screen();
            let mut bytes = screen.state_formatted().into_bytes();
            if screen.alternate_screen() {
                bytes.extend_from_slice(REPORT_FOCUS);
            }
            return Some(Output::Bytes(bytes));
        }
        if let Some(notice) = pending.notices.pop_front() {
            return Some(Output::Notice(notice));
        }
        if !pending.bytes.is_empty() {
            return Some(Output::Bytes(std::mem::take(&mut pending.bytes)));
        }
        pending.closed.clone().map(Output::Closed)
    }

    pub fn send_input(&self, queue: &ClientQueue, bytes: &[u8]) {
        let mut state = self.lock();
        if !state.is_client(queue) {
            return;
        }
        state.last_input = Some(Instant::now());
        if let Some(process) = &state.process {
            // Input is discarded if 1024 messages wait for a process that does not read.
            let _ = process.input.try_send(bytes.to_vec());
        }
    }

    pub fn resize(&self, queue: &ClientQueue, size: WindowSize) {
        let mut state = self.lock();
        if state.is_client(queue) {
            state.set_size(size);
        }
    }

    /// Detaches a client. The process ends if no client attaches for some time.
    pub fn detach(self: &Arc<Self>, queue: &ClientQueue) {
        let changes = {
            let mut state = self.lock();
            if !state.is_client(queue) {
                return;
            }
            state.client = None;
            state.connected_at = None;
            state.client_changes += 1;
            state.client_changes
        };
        self.record(&AuditEvent::Detached { label: self.label.clone(), client: queue.kind.to_string() });
        let session = self.clone();
        let Ok(runtime) = tokio::runtime::Handle::try_current() else { return };
        runtime.spawn(async move {
            tokio::time::sleep(session.program.absence_limit).await;
            let _guard = session.lifecycle.lock().await;
            if session.lock().client_changes == changes {
                session.end_process(CloseReason::Ended).await;
            }
        });
    }

    /// Ends the process and closes the connection of the client. Waits until the process has saved.
    pub async fn close(&self, reason: CloseReason) {
        let _guard = self.lifecycle.lock().await;
        self.end_process(reason).await;
    }

    async fn end_process(&self, reason: CloseReason) {
        let id = {
            let mut state = self.lock();
            let Some(process) = &mut state.process else { return };
            process.closing = Some(reason);
            process.id
        };
        send_signal(id, Signal::HUP);
        if timeout(SAVE_TIMEOUT, self.wait_for_end()).await.is_err() {
            send_signal(id, Signal::KILL);
            self.wait_for_end().await;
        }
    }

    async fn wait_for_end(&self) {
        loop {
            let ended = self.process_ended.notified();
            tokio::pin!(ended);
            ended.as_mut().enable();
            if self.lock().process.is_none() {
                return;
            }
            ended.await;
        }
    }

    /// Sends a message to the client. Returns whether a client is connected.
    pub fn notify(&self, notice: Notice) -> bool {
        let state = self.lock();
        let Some(client) = &state.client else { return false };
        client.update(|pending| pending.notices.push_back(notice));
        true
    }

    pub fn process_number(&self) -> u64 {
        self.lock().process_number
    }

    /// Appends an event to the audit log. A session continues if the log cannot be written; attaching does not.
    fn record(&self, event: &AuditEvent) {
        self.audit.record(event);
    }

    pub fn activity(&self) -> Activity {
        let state = self.lock();
        Activity {
            client: state.client.as_ref().map(|client| client.kind.clone()),
            is_running: state.process.is_some(),
            connected_for: state.connected_at.map(|at| at.elapsed()),
            idle_for: state.last_input.map(|at| at.elapsed()),
        }
    }
}

fn blank_screen(size: WindowSize) -> vt100::Parser {
    let (rows, columns) = at_least_one(size);
    vt100::Parser::new(rows, columns, 0)
}

fn at_least_one(size: WindowSize) -> (NonZero<u16>, NonZero<u16>) {
    let at_least_one = |count| NonZero::new(count).unwrap_or(NonZero::<u16>::MIN);
    (at_least_one(size.rows), at_least_one(size.columns))
}

impl State {
    fn is_client(&self, queue: &ClientQueue) -> bool {
        self.client.as_ref().is_some_and(|client| std::ptr::eq(&**client, queue))
    }

    fn set_size(&mut self, size: WindowSize) {
        if self.size == size {
            return;
        }
        self.size = size;
        let (rows, columns) = at_least_one(size);
        self.screen.screen_mut().set_size(rows, columns);
        if let Some(process) = &self.process {
            // A failure leaves the old size, with which the session still works.
            let _ = process.terminal.resize(size);
        }
    }
}
