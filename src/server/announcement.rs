//! What is told once a run takes requests.

use std::path::PathBuf;

use serde::Serialize;

/// Where a run is served.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Announcement {
    /// The run.
    pub run: String,
    /// Port on 127.0.0.1.
    pub port: u16,
    /// Process of the server.
    pub pid: u32,
    /// File with the token that requests must carry, if they must.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub token: Option<PathBuf>,
}
