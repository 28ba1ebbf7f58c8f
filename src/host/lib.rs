//! Hosted sessions: a host runs one process per participant in a pseudo terminal, and participants attach to it with a
//! browser or over ssh (docs/studies/hosting.md).
//!
//! All files of a hosted study are in its host folder. Clients receive screens and send keys; they never read a file of
//! the study.


#![cfg(unix)]

mod attachment;
mod folder;
mod process;
mod session;
mod sessions;

pub use attachment::{AttachError, Attachment, ClientKind, CloseReason, Notice, Output, WindowSize};
pub use folder::{HOST_FOLDER, HostFolder, ProgramVersion};
pub use process::SessionProgram;
pub use sessions::{ControlError, SessionState, SessionStatus, Sessions};
