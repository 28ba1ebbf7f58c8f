//! What is told once a run takes requests, and the file in its folder by which others find the server again, or see that a
//! program plays it.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;
use novamind_record::files::write_whole;
use novamind_record::folder::lock::SERVER_FILE;

/// Where a run is served.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Announcement {
    /// The run.
    pub run: String,
    /// Port on 127.0.0.1; none where a client plays over standard input and output, and nobody else can ask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub port: Option<u16>,
    /// Process of the server.
    pub pid: u32,
    /// File with the token that requests must carry, if they must.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub token: Option<PathBuf>,
}

impl Announcement {
    /// Puts it into the folder of the run, whole or not at all. Only who holds the run may do so.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn put_up(&self, folder: &Path) -> Result<(), RunError> {
        let text = serde_json::to_string(self).unwrap_or_default() + "\n";
        write_whole(&folder.join(SERVER_FILE), text.as_bytes())
    }

    /// Takes away what stands in the folder of a run.
    pub fn take_down(folder: &Path) {
        // Whoever finds it left behind asks the port first.
        let _ = std::fs::remove_file(folder.join(SERVER_FILE));
    }

    /// What stands in the folder of a run; the server may be gone. None where nothing that can be read is there.
    pub fn read(folder: &Path) -> Option<Announcement> {
        serde_json::from_slice(&std::fs::read(folder.join(SERVER_FILE)).ok()?).ok()
    }
}
