//! The announcement of a server: a file in the run folder. From this file, other processes find the server or detect
//! that a program plays the run.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;
use novamind_record::files::write_atomically;
use novamind_record::folder::lock::SERVER_FILE;

/// The address of a server, and the run that it plays.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Announcement {
    /// ID of the served run.
    pub run: String,
    /// Port on 127.0.0.1. `None` if the server uses standard input and output, so that no other process can connect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub port: Option<u16>,
    /// Process id of the server, for messages to the user.
    pub pid: u32,
    /// File with the token that requests must include, if a token is required.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub token: Option<PathBuf>,
}

impl Announcement {
    /// Writes the announcement to the run folder atomically. The caller must have locked the run.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), RunError> {
        let text = serde_json::to_string(self).unwrap_or_default() + "\n";
        write_atomically(&folder.join(SERVER_FILE), text.as_bytes())
    }

    /// Removes the announcement from a run folder.
    pub fn remove(folder: &Path) {
        // Ignore errors, because readers of a leftover file check whether the server responds.
        let _ = std::fs::remove_file(folder.join(SERVER_FILE));
    }

    /// Reads the announcement in a run folder, which may be left over from a server that ended. Returns `None` if
    /// there is no readable file.
    pub fn read(folder: &Path) -> Option<Announcement> {
        serde_json::from_slice(&std::fs::read(folder.join(SERVER_FILE)).ok()?).ok()
    }
}
