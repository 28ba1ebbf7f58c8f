//! The running host: its socket, its sessions, and its end.

use std::fmt;
use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;

use tokio::net::TcpListener;
use tokio::signal::unix::{SignalKind, signal};

use novamind_record::error::RunError;

use crate::audit::AuditEvent;
use crate::folder::HostFolder;
use crate::process::SessionProgram;
use crate::sessions::Sessions;
use crate::socket::HostSocket;
use crate::web::{WebOptions, serve_web};

/// Settings of a host.
#[derive(Debug, Clone)]
pub struct HostOptions {
    /// Address on which the host accepts browsers.
    pub listen: SocketAddr,
    /// Settings of the web server.
    pub web: WebOptions,
    /// Path of the socket for `novamind host attach`.
    pub socket: PathBuf,
    /// Account that several participants share.
    pub shared_account: Option<String>,
    /// Version of the program, for the audit log.
    pub version: String,
    /// Whether the processes of sessions are restricted.
    pub is_sandboxed: bool,
}

/// The reason why a host cannot start.
#[derive(Debug)]
pub enum HostError {
    /// A file of the host folder cannot be read or written.
    Folder(RunError),
    /// A socket or the system failed. The text names the subject.
    Io(String, io::Error),
}

impl fmt::Display for HostError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            HostError::Folder(error) => error.fmt(out),
            HostError::Io(subject, error) => write!(out, "{subject}: {error}; the host did not start"),
        }
    }
}

impl std::error::Error for HostError {}

impl From<RunError> for HostError {
    fn from(error: RunError) -> HostError {
        HostError::Folder(error)
    }
}

/// Serves the sessions of a host folder until SIGINT, SIGTERM or SIGHUP. Then all sessions save and end. `when_ready` is
/// called with the address for browsers when clients can connect.
///
/// # Errors
/// The host cannot start.
pub fn serve_host(
    folder: HostFolder,
    program: &SessionProgram,
    options: &HostOptions,
    when_ready: impl FnOnce(SocketAddr),
) -> Result<(), HostError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|error| HostError::Io("threads".to_owned(), error))?;
    runtime.block_on(async {
        let system = |error| HostError::Io("signals".to_owned(), error);
        let mut interrupted = signal(SignalKind::interrupt()).map_err(system)?;
        let mut terminated = signal(SignalKind::terminate()).map_err(system)?;
        let mut hung_up = signal(SignalKind::hangup()).map_err(system)?;
        let named = |error| HostError::Io(options.socket.display().to_string(), error);
        let socket = HostSocket::bind(&options.socket).map_err(named)?;
        let unavailable = |error| HostError::Io(format!("address {}", options.listen), error);
        let listener = TcpListener::bind(options.listen).await.map_err(unavailable)?;
        let listens_on = listener.local_addr().map_err(unavailable)?;
        let sessions = Sessions::new(folder, program)?;
        let started =
            AuditEvent::HostStarted { version: options.version.clone(), sandbox: options.is_sandboxed };
        sessions.audit().append(&started)?;
        when_ready(listens_on);
        tokio::select! {
            () = socket.serve(sessions.clone(), options.shared_account.clone()) => {}
            () = serve_web(listener, listens_on, sessions.clone(), options.web.clone()) => {}
            _ = interrupted.recv() => {}
            _ = terminated.recv() => {}
            _ = hung_up.recv() => {}
        }
        sessions.shut_down().await;
        sessions.record(&AuditEvent::HostStopped);
        Ok(())
    })
}
