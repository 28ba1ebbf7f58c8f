//! The Unix socket of the host, to which `novamind host attach` connects. The kernel reports which account connects.

use std::io;
use std::os::unix::fs::{FileTypeExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use tokio::net::{UnixListener, UnixStream};
use tokio::sync::{Mutex, Semaphore};
use tokio::time::timeout;

use crate::access::Access;
use crate::attachment::{Attachment, ClientKind, Output, WindowSize};
use crate::audit::AuditEvent;
use crate::frames::{ClientMessage, HostMessage, receive, send};
use crate::sessions::Sessions;

/// Maximum number of connections. More connections wait.
const MAX_CONNECTIONS: usize = 256;
/// Time within which a client must send its first message.
const HELLO_TIMEOUT: Duration = Duration::from_secs(10);
/// Time within which a user must enter label and code.
const CODE_TIMEOUT: Duration = Duration::from_secs(120);
/// Time that a wrong code costs. Codes of all clients are checked one after the other.
const WRONG_CODE_DELAY: Duration = Duration::from_secs(1);
/// Number of codes that a user can enter in one connection.
const MAX_CODES: u32 = 3;

/// The socket of a host, which is removed when the value is dropped.
#[derive(Debug)]
pub struct HostSocket {
    listener: UnixListener,
    path: PathBuf,
}

/// An account of this machine.
#[derive(Debug, Clone)]
struct Account {
    uid: u32,
    name: String,
}

/// The sessions that an account may attach to.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Permission {
    /// Every session: the accounts of the host and of the administrator.
    All,
    /// The session with this label.
    Only(String),
    /// The session whose code the user enters.
    WithCode,
}

#[derive(Debug)]
struct SocketHost {
    sessions: Sessions,
    /// Name of the account that several participants share.
    shared_account: Option<String>,
    /// Held while a code is checked.
    code_check: Mutex<()>,
}

impl HostSocket {
    /// Creates the socket. All accounts can connect to it if they can reach its folder. An existing socket without a host
    /// is replaced. Needs a tokio runtime.
    ///
    /// # Errors
    /// Another host uses the socket, the path is too long or not a socket, or the socket cannot be created.
    pub fn bind(path: &Path) -> io::Result<HostSocket> {
        if let Ok(metadata) = std::fs::symlink_metadata(path) {
            if !metadata.file_type().is_socket() {
                return Err(io::Error::other("the file exists and is not a socket"));
            }
            if std::os::unix::net::UnixStream::connect(path).is_ok() {
                return Err(io::Error::new(io::ErrorKind::AddrInUse, "another host uses this socket"));
            }
            std::fs::remove_file(path)?;
        }
        let listener = UnixListener::bind(path)?;
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o666))?;
        Ok(HostSocket { listener, path: path.to_owned() })
    }

    /// Serves clients. Runs until it is dropped. `shared_account` is the account whose users enter label and code.
    pub async fn serve(&self, sessions: Sessions, shared_account: Option<String>) {
        let host = Arc::new(SocketHost { sessions, shared_account, code_check: Mutex::new(()) });
        let places = Arc::new(Semaphore::new(MAX_CONNECTIONS));
        loop {
            let Ok(place) = places.clone().acquire_owned().await else { return };
            match self.listener.accept().await {
                Ok((stream, _)) => {
                    let host = host.clone();
                    tokio::spawn(async move {
                        // A client that disconnects does not affect the host.
                        let _ = host.serve_client(stream).await;
                        drop(place);
                    });
                }
                // Too many files are open. The next attempt may succeed.
                Err(_) => tokio::time::sleep(Duration::from_millis(50)).await,
            }
        }
    }
}

impl Drop for HostSocket {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

impl SocketHost {
    async fn serve_client(&self, mut stream: UnixStream) -> io::Result<()> {
        let peer = stream.peer_cred()?;
        let account = Account::of_uid(peer.uid()).await;
        let hello = timeout(HELLO_TIMEOUT, receive(&mut stream)).await?;
        let ClientMessage::Hello { label, columns, rows } = hello? else { return Ok(()) };
        let client = ClientKind::Terminal(account.name.clone());
        if self.permission(&account) == Permission::All && is_restricted(peer.pid()) {
            let reason = "restricted processes, such as sessions, cannot attach to sessions".to_owned();
            let label = label.unwrap_or_default().chars().take(40).collect();
            let client = client.to_string();
            self.sessions.record(&AuditEvent::AttachRefused { label, client, reason: reason.clone() });
            return send(&mut stream, &HostMessage::Refused(reason)).await;
        }
        let label = match self.permitted_label(&account, label, &mut stream).await? {
            Ok(label) => label,
            Err((label, reason)) => {
                let refused =
                    AuditEvent::AttachRefused { label, client: client.to_string(), reason: reason.clone() };
                self.sessions.record(&refused);
                return send(&mut stream, &HostMessage::Refused(reason)).await;
            }
        };
        match self.sessions.attach(&label, client, WindowSize::clamped(columns, rows)).await {
            Ok(attachment) => {
                send(&mut stream, &HostMessage::Attached { label }).await?;
                relay(stream, attachment).await
            }
            Err(error) => send(&mut stream, &HostMessage::Refused(error.to_string())).await,
        }
    }

    /// Returns the label of the session that the client may attach to, or the label that it named with the reason of the
    /// refusal.
    async fn permitted_label(
        &self,
        account: &Account,
        named: Option<String>,
        stream: &mut UnixStream,
    ) -> io::Result<Result<String, (String, String)>> {
        match (self.permission(account), named) {
            (Permission::All, Some(label)) => Ok(Ok(label)),
            (Permission::All, None) => {
                Ok(Err((String::new(), "name the session: novamind host attach LABEL".to_owned())))
            }
            (Permission::Only(label), None) => Ok(Ok(label)),
            (Permission::Only(label), Some(named)) if named == label => Ok(Ok(label)),
            (Permission::Only(label), Some(named)) => {
                Ok(Err((named, format!("the account {label} can open only the session {label}"))))
            }
            (Permission::WithCode, _) => self.ask_for_code(stream).await,
        }
    }

    fn permission(&self, account: &Account) -> Permission {
        if account.uid == 0 || account.uid == rustix::process::getuid().as_raw() {
            Permission::All
        } else if self.shared_account.as_ref() == Some(&account.name) {
            Permission::WithCode
        } else {
            Permission::Only(account.name.clone())
        }
    }

    async fn ask_for_code(&self, stream: &mut UnixStream) -> io::Result<Result<String, (String, String)>> {
        let mut last_label = String::new();
        for _ in 0..MAX_CODES {
            send(stream, &HostMessage::AskForCode).await?;
            let answer = timeout(CODE_TIMEOUT, receive(stream)).await?;
            let ClientMessage::Code { label, code } = answer? else { break };
            let _guard = self.code_check.lock().await;
            let access: Access = self.sessions.access().clone();
            let checked = label.clone();
            let is_right = tokio::task::spawn_blocking(move || access.accepts_code(&checked, &code)).await;
            if is_right.unwrap_or(false) {
                return Ok(Ok(label));
            }
            tokio::time::sleep(WRONG_CODE_DELAY).await;
            last_label = label.chars().take(40).collect();
        }
        Ok(Err((
            last_label,
            "the label or the code is wrong: check both, or ask the experimenter".to_owned(),
        )))
    }
}

impl Account {
    /// Returns the account with this number. Accounts without a name get a name that no participant can have.
    async fn of_uid(uid: u32) -> Account {
        // `id` also knows accounts of directory services.
        let output =
            tokio::process::Command::new("/usr/bin/id").args(["-nu", &uid.to_string()]).output().await;
        let name = output.ok().filter(|output| output.status.success());
        let name = name.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
        Account { uid, name: name.filter(|name| !name.is_empty()).unwrap_or_else(|| format!("#{uid}")) }
    }
}

/// Returns whether a process may be a session that a participant controls. Sessions have the account of the host, and
/// cannot remove the flag that Landlock requires. A process that has ended counts as restricted.
#[cfg(target_os = "linux")]
fn is_restricted(process: Option<i32>) -> bool {
    let status = process.and_then(|id| std::fs::read_to_string(format!("/proc/{id}/status")).ok());
    let is_free = |line: &str| line.split_whitespace().eq(["NoNewPrivs:", "0"]);
    !status.is_some_and(|status| status.lines().any(is_free))
}

/// Returns whether a process may be a session that a participant controls. Only Linux restricts sessions.
#[cfg(not(target_os = "linux"))]
fn is_restricted(_process: Option<i32>) -> bool {
    false
}

/// Passes messages between a client and its session until one of them ends.
async fn relay(stream: UnixStream, mut attachment: Attachment) -> io::Result<()> {
    let (mut from, mut to) = stream.into_split();
    // A separate task, because a message must not be read in parts.
    let (messages, mut received) = tokio::sync::mpsc::channel(16);
    let reader = tokio::spawn(async move {
        while let Ok(message) = receive::<ClientMessage>(&mut from).await {
            if messages.send(message).await.is_err() {
                return;
            }
        }
    });
    let result = loop {
        tokio::select! {
            message = received.recv() => match message {
                Some(ClientMessage::Input(bytes)) => attachment.send_input(&bytes),
                Some(ClientMessage::Resize { columns, rows }) => {
                    attachment.resize(WindowSize::clamped(columns, rows));
                }
                Some(ClientMessage::Redraw) => attachment.request_screen(),
                _ => break Ok(()),
            },
            output = attachment.next_output() => {
                let (message, is_last) = match output {
                    Output::Bytes(bytes) => (HostMessage::Output(bytes), false),
                    Output::Notice(notice) => (HostMessage::Notice(notice.to_string()), false),
                    Output::Closed(reason) => (HostMessage::Closed(reason.to_string()), true),
                };
                // A client that does not read blocks only this connection; its output is replaced by the current screen.
                let sent = send(&mut to, &message).await;
                if is_last || sent.is_err() {
                    break sent;
                }
            }
        }
    };
    reader.abort();
    result
}
