//! `audit.jsonl`: connections, wrong tokens and codes, and actions of the experimenter. Each line contains the digest of
//! the line before it, so a changed or removed line breaks the chain, except at its end.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::open_regular_file_for_append;
use novamind_session::Machine;

/// Name of the audit log in the host folder.
pub const AUDIT_FILE: &str = "audit.jsonl";
/// Maximum size of a line. The end of the file is read to find the last line.
const MAX_LINE_BYTES: usize = 16 << 10;

/// The audit log of a host folder. Several processes can append to it.
#[derive(Debug, Clone)]
pub struct AuditLog {
    path: Arc<PathBuf>,
    report: fn(&str),
}

/// An event of the audit log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum AuditEvent {
    /// The host started.
    HostStarted {
        /// Version of the program.
        version: String,
        /// Whether the processes of sessions are restricted.
        sandbox: bool,
    },
    /// The host stopped, and all sessions were saved.
    HostStopped,
    /// Links and codes were created. Earlier ones of these participants became invalid.
    LinksIssued {
        /// Labels of the participants.
        labels: Vec<String>,
    },
    /// A client attached to a session.
    Attached {
        /// Label of the session.
        label: String,
        /// The client, with its address or account.
        client: String,
    },
    /// A client was not allowed to attach to a session.
    AttachRefused {
        /// Label that the client named; empty if it named none.
        label: String,
        /// The client, with its address or account.
        client: String,
        /// The reason.
        reason: String,
    },
    /// A client disconnected, or was disconnected.
    Detached {
        /// Label of the session.
        label: String,
        /// The client, with its address or account.
        client: String,
    },
    /// The process of a session started.
    ProcessStarted {
        /// Label of the session.
        label: String,
    },
    /// The process of a session ended.
    ProcessEnded {
        /// Label of the session.
        label: String,
        /// Exit code or signal.
        status: String,
    },
    /// A wrong token was used in a link.
    WrongToken {
        /// Network address of the client.
        address: String,
    },
    /// A wrong code was entered on the experimenter's page.
    WrongAdminCode {
        /// Network address of the client.
        address: String,
    },
    /// The code was entered on the experimenter's page.
    AdminSignedIn {
        /// Network address of the client.
        address: String,
    },
    /// The experimenter acted on a session.
    Act {
        /// Label of the session.
        label: String,
        /// Name of the action.
        action: &'static str,
        /// Text of a message or a reason.
        text: String,
        /// Network address of the experimenter's browser.
        address: String,
    },
}

#[derive(Serialize)]
struct AuditLine<'a> {
    at: String,
    monotonic_ms: u64,
    boot: String,
    previous: String,
    #[serde(flatten)]
    event: &'a AuditEvent,
}

/// The part of a line that the check of the chain reads.
#[derive(Deserialize)]
struct ChainedLine {
    previous: String,
    event: String,
    #[serde(flatten)]
    _rest: serde_json::Map<String, Value>,
}

impl AuditLog {
    /// Returns the audit log of a host folder. `report` is called with a message if [`AuditLog::record`] fails.
    pub(crate) fn of_folder(host_folder: &Path, report: fn(&str)) -> AuditLog {
        AuditLog { path: Arc::new(host_folder.join(AUDIT_FILE)), report }
    }

    /// Appends an event. A failure is reported, and the caller continues.
    pub fn record(&self, event: &AuditEvent) {
        if let Err(error) = self.append(event) {
            (self.report)(&format!("the audit log was not written: {error}"));
        }
    }

    /// Appends an event and syncs the file.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn append(&self, event: &AuditEvent) -> Result<(), RunError> {
        let path = self.path.as_path();
        self.append_locked(event).map_err(RunError::io(path))
    }

    fn append_locked(&self, event: &AuditEvent) -> std::io::Result<()> {
        let mut file = open_regular_file_for_append(&self.path)?;
        file.lock()?;
        let end = read_end(&mut file)?;
        let ends_with_line = end.is_empty() || end.ends_with(b"\n");
        let machine = Machine::current();
        let line = AuditLine {
            at: now(),
            monotonic_ms: Machine::monotonic_ms(),
            boot: machine.boot,
            previous: line_digest(last_line(&end)),
            event,
        };
        // A line that a crash has cut stays as it is, and the check reports it.
        let start = if ends_with_line { "" } else { "\n" };
        let text = format!("{start}{}\n", serde_json::to_string(&line)?);
        file.write_all(text.as_bytes())?;
        file.sync_data()
    }

    /// Checks the chain of an audit log. Returns the number of lines.
    ///
    /// # Errors
    /// Returns the number of the first line that is damaged or does not follow from the line before it.
    pub fn verify(text: &str) -> Result<usize, usize> {
        let mut previous = "";
        for (at, line) in text.lines().enumerate() {
            let parsed: ChainedLine = serde_json::from_str(line).map_err(|_| at + 1)?;
            if parsed.previous != line_digest(previous.as_bytes()) || parsed.event.is_empty() {
                return Err(at + 1);
            }
            previous = line;
        }
        Ok(text.lines().count())
    }
}

fn read_end(file: &mut File) -> std::io::Result<Vec<u8>> {
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(2 * MAX_LINE_BYTES as u64)))?;
    let mut end = Vec::new();
    file.read_to_end(&mut end)?;
    Ok(end)
}

fn last_line(end: &[u8]) -> &[u8] {
    let end = end.strip_suffix(b"\n").unwrap_or(end);
    let start = end.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    &end[start..]
}

/// Returns the digest that the next line contains, or an empty text before the first line.
fn line_digest(line: &[u8]) -> String {
    if line.is_empty() { String::new() } else { blake3::hash(line).to_hex().to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chain_detects_changed_and_removed_lines() {
        let folder = tempfile::tempdir().expect("a folder");
        let log = AuditLog::of_folder(folder.path(), |problem| panic!("{problem}"));
        for address in ["192.0.2.1", "192.0.2.2", "192.0.2.3"] {
            log.append(&AuditEvent::WrongToken { address: address.to_owned() }).expect("appended");
        }
        let text = std::fs::read_to_string(folder.path().join(AUDIT_FILE)).expect("a file");
        assert_eq!(AuditLog::verify(&text), Ok(3));
        assert_eq!(AuditLog::verify(&text.replace("192.0.2.1", "192.0.2.9")), Err(2));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(AuditLog::verify(&[lines[0], lines[2]].join("\n")), Err(2));
        assert_eq!(AuditLog::verify(&[lines[1], lines[2]].join("\n")), Err(1));
    }

    #[test]
    fn line_cut_by_a_crash_is_kept_and_reported() {
        let folder = tempfile::tempdir().expect("a folder");
        let log = AuditLog::of_folder(folder.path(), |problem| panic!("{problem}"));
        log.append(&AuditEvent::HostStopped).expect("appended");
        let path = folder.path().join(AUDIT_FILE);
        let mut text = std::fs::read_to_string(&path).expect("a file");
        text += "{\"at\":\"20";
        std::fs::write(&path, &text).expect("written");
        log.append(&AuditEvent::HostStopped).expect("appended");
        let continued = std::fs::read_to_string(&path).expect("a file");
        assert!(continued.starts_with(&text));
        assert_eq!(AuditLog::verify(&continued), Err(2));
    }
}
