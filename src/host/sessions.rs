//! All sessions of a hosted study.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;
use novamind_record::files::{read_if_exists, write_private_atomically};

use crate::access::Access;
use crate::attachment::{AttachError, Attachment, ClientKind, CloseReason, Notice, WindowSize};
use crate::audit::{AuditEvent, AuditLog};
use crate::folder::HostFolder;
use crate::process::SessionProgram;
use crate::session::HostedSession;

/// Name of the file with the states of sessions that are not open.
const STATES_FILE: &str = "states.json";

/// The sessions of a hosted study. Copies refer to the same sessions. The methods need a tokio runtime.
#[derive(Debug, Clone)]
pub struct Sessions(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    folder: HostFolder,
    access: Access,
    audit: AuditLog,
    sessions: BTreeMap<String, Arc<HostedSession>>,
    states: Mutex<BTreeMap<String, SessionState>>,
    is_shutting_down: AtomicBool,
}

/// Whether the participant may play.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SessionState {
    /// The participant may play.
    #[default]
    Open,
    /// The experimenter has paused the session.
    Paused,
    /// The experimenter has ended the session, with this reason.
    Ended(String),
}

/// The state of a session, as the experimenter sees it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SessionStatus {
    /// Label of the participant.
    pub label: String,
    /// Whether the participant may play.
    pub state: SessionState,
    /// The connected client.
    pub client: Option<ClientKind>,
    /// Whether the process of the session is running.
    pub is_running: bool,
    /// Time since the client connected.
    pub connected_for: Option<Duration>,
    /// Time since the last input since the host started.
    pub idle_for: Option<Duration>,
}

/// The reason why an action of the experimenter failed.
#[derive(Debug)]
pub enum ControlError {
    /// The study has no session with this label.
    UnknownLabel,
    /// The session has ended and cannot be paused or resumed.
    HasEnded,
    /// No client is connected that could receive a message.
    NotConnected,
    /// The new state cannot be saved.
    Save(RunError),
}

impl fmt::Display for ControlError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ControlError::UnknownLabel => out.write_str("this label is not in the study"),
            ControlError::HasEnded => out.write_str("this session has been ended"),
            ControlError::NotConnected => {
                out.write_str("the participant is not connected; the message was not sent")
            }
            ControlError::Save(error) => write!(out, "the new state of the session was not saved: {error}"),
        }
    }
}

impl std::error::Error for ControlError {}

impl Sessions {
    /// Returns the sessions of a host folder. No process is started.
    ///
    /// # Errors
    /// The states of the sessions cannot be read.
    pub fn new(folder: HostFolder, program: &SessionProgram) -> Result<Sessions, RunError> {
        let path = folder.path().join(STATES_FILE);
        let states = match read_if_exists(&path)? {
            None => BTreeMap::new(),
            Some(bytes) => serde_json::from_slice(&bytes)
                .map_err(|error| RunError::InvalidRequest(format!("{}: {error}", path.display())))?,
        };
        let (access, audit) = (folder.access(), folder.audit());
        let session = |label: &str| {
            let path = folder.session_folder(label);
            Arc::new(HostedSession::new(label.to_owned(), path, program.clone(), audit.clone()))
        };
        let sessions = folder.labels().map(|label| (label.to_owned(), session(label))).collect();
        let (states, is_shutting_down) = (Mutex::new(states), AtomicBool::new(false));
        Ok(Sessions(Arc::new(Shared { folder, access, audit, sessions, states, is_shutting_down })))
    }

    /// Returns the host folder.
    pub fn folder(&self) -> &HostFolder {
        &self.0.folder
    }

    /// Returns the access of the participants.
    pub fn access(&self) -> &Access {
        &self.0.access
    }

    /// Returns the label of the participant with this link token, or `None` if no session of the study has it.
    pub fn label_for_token(&self, token: &str) -> Option<String> {
        self.0.access.label_for_token(token).filter(|label| self.0.sessions.contains_key(label))
    }

    /// Returns the audit log.
    pub fn audit(&self) -> &AuditLog {
        &self.0.audit
    }

    /// Appends an event to the audit log. A failure is reported, and the host continues.
    pub fn record(&self, event: &AuditEvent) {
        self.0.audit.record(event);
    }

    /// Attaches a client to a session. An earlier client of the session is disconnected. Starts the process of the session
    /// if it is not running.
    ///
    /// # Errors
    /// The session does not exist, may not be played now, or cannot be started.
    pub async fn attach(
        &self,
        label: &str,
        client: ClientKind,
        size: WindowSize,
    ) -> Result<Attachment, AttachError> {
        let session = self.0.sessions.get(label).ok_or(AttachError::UnknownLabel)?;
        self.check_open(label)?;
        let attachment = session.attach(client, size).await?;
        // The session may have been paused while an earlier process was ending.
        let Err(error) = self.check_open(label) else { return Ok(attachment) };
        session.close(CloseReason::Ended).await;
        Err(error)
    }

    fn check_open(&self, label: &str) -> Result<(), AttachError> {
        if self.0.is_shutting_down.load(Ordering::SeqCst) {
            return Err(AttachError::Shutdown);
        }
        match self.state(label) {
            SessionState::Open => Ok(()),
            SessionState::Paused => Err(AttachError::Paused),
            SessionState::Ended(reason) => Err(AttachError::Ended(reason)),
        }
    }

    /// Returns the states of all sessions, in the order of the assignment.
    pub fn statuses(&self) -> Vec<SessionStatus> {
        let status = |label: &str| {
            let activity = self.0.sessions.get(label)?.activity();
            Some(SessionStatus {
                label: label.to_owned(),
                state: self.state(label),
                client: activity.client,
                is_running: activity.is_running,
                connected_for: activity.connected_for,
                idle_for: activity.idle_for,
            })
        };
        self.0.folder.labels().filter_map(status).collect()
    }

    /// Returns whether the participant may play. Unknown labels are open.
    pub fn state(&self, label: &str) -> SessionState {
        self.states().get(label).cloned().unwrap_or_default()
    }

    /// Ends the process of a session, and refuses clients until the session is resumed.
    ///
    /// # Errors
    /// The session does not exist or has ended, or its state cannot be saved.
    pub async fn pause(&self, label: &str) -> Result<(), ControlError> {
        self.change_state(label, SessionState::Paused)?;
        self.close(label, CloseReason::Paused).await
    }

    /// Accepts clients of a paused session again.
    ///
    /// # Errors
    /// The session does not exist or has ended, or its state cannot be saved.
    pub async fn resume(&self, label: &str) -> Result<(), ControlError> {
        self.change_state(label, SessionState::Open)
    }

    /// Ends a session for good. Its records are kept.
    ///
    /// # Errors
    /// The session does not exist or has ended, or its state cannot be saved.
    pub async fn end(&self, label: &str, reason: &str) -> Result<(), ControlError> {
        self.change_state(label, SessionState::Ended(reason.trim().to_owned()))?;
        self.close(label, CloseReason::Ended).await
    }

    /// Shows a message to a participant.
    ///
    /// # Errors
    /// The session does not exist, or no client is connected.
    pub fn message(&self, label: &str, text: &str) -> Result<(), ControlError> {
        let session = self.0.sessions.get(label).ok_or(ControlError::UnknownLabel)?;
        let is_sent = session.notify(Notice::Experimenter(text.trim().to_owned()));
        if is_sent { Ok(()) } else { Err(ControlError::NotConnected) }
    }

    /// Ends the processes of all sessions and refuses clients. Waits until all processes have saved.
    pub async fn shut_down(&self) {
        self.0.is_shutting_down.store(true, Ordering::SeqCst);
        let closing = self
            .0
            .sessions
            .values()
            .cloned()
            .map(|session| tokio::spawn(async move { session.close(CloseReason::Shutdown).await }));
        for task in closing.collect::<Vec<_>>() {
            let _ = task.await;
        }
    }

    async fn close(&self, label: &str, reason: CloseReason) -> Result<(), ControlError> {
        let session = self.0.sessions.get(label).ok_or(ControlError::UnknownLabel)?;
        session.close(reason).await;
        Ok(())
    }

    fn states(&self) -> MutexGuard<'_, BTreeMap<String, SessionState>> {
        self.0.states.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Saves the new state of a session.
    fn change_state(&self, label: &str, state: SessionState) -> Result<(), ControlError> {
        if !self.0.sessions.contains_key(label) {
            return Err(ControlError::UnknownLabel);
        }
        let mut states = self.states();
        if matches!(states.get(label), Some(SessionState::Ended(_))) {
            return Err(ControlError::HasEnded);
        }
        let mut changed = states.clone();
        changed.insert(label.to_owned(), state);
        let text = serde_json::to_vec_pretty(&changed).unwrap_or_default();
        write_private_atomically(&self.0.folder.path().join(STATES_FILE), &text)
            .map_err(ControlError::Save)?;
        *states = changed;
        Ok(())
    }
}
