//! Hosted sessions: a host runs one process per participant in a pseudo terminal, and participants attach to it with a
//! browser or over ssh (docs/studies/hosting.md).
//!
//! All files of a hosted study are in its host folder. Clients receive screens and send keys; they never read a file of
//! the study.
#![cfg(unix)]

mod access;
mod attach;
mod attachment;
mod audit;
mod folder;
mod frames;
mod process;
mod sandbox;
mod serve;
mod session;
mod sessions;
mod socket;
mod web;

pub use access::{Access, Credentials};
pub use attach::{AttachFailure, attach_terminal};
pub use attachment::{AttachError, Attachment, ClientKind, CloseReason, Notice, Output, WindowSize};
pub use audit::{AUDIT_FILE, AuditEvent, AuditLog};
pub use folder::{HOST_FOLDER, HostFolder, ProgramVersion};
pub use process::{SessionProgram, take_terminal};
pub use sandbox::{
    SandboxError, check_sandbox_support, limit_session_resources, restrict_to_script, restrict_to_session,
};
pub use serve::{HostError, HostOptions, serve_host};
pub use sessions::{ControlError, SessionState, SessionStatus, Sessions};
pub use socket::HostSocket;
pub use web::{PublicAddress, WebOptions, serve_web};

#[cfg(test)]
mod tests;
