//! Where a run is served: a small file in its folder, for whoever looks for the server of a run.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::session::{RunError, is_locked, write_whole};

const FILE: &str = "server.json";

/// Where a run is served.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Announcement {
    /// The run.
    pub run: String,
    /// Port on 127.0.0.1.
    pub port: u16,
    /// Process of the server.
    pub pid: u32,
    /// File with the token that requests must carry, if they must.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub token: Option<PathBuf>,
}

/// An announcement that stands as long as this does.
pub struct Announced(PathBuf);

impl Announcement {
    /// Writes it into the folder of the run.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn publish(&self, folder: &Path) -> Result<Announced, RunError> {
        let path = folder.join(FILE);
        let text = json!(self);
        write_whole(&path, format!("{text}\n").as_bytes())?;
        Ok(Announced(path))
    }
}

impl Drop for Announced {
    fn drop(&mut self) {
        // A file that stays is seen through: nobody holds the lock of the run then.
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Where the run of a folder is served at this moment, if it is.
pub fn announced(folder: &Path) -> Option<Announcement> {
    if !is_locked(folder) {
        return None;
    }
    let text = std::fs::read_to_string(folder.join(FILE)).ok()?;
    serde_json::from_str(&text).ok()
}
