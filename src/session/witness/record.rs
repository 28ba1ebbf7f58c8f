//! What a witness was told, as its folder holds it: a file for each run and machine, one JSON line per line told.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::session::error::RunError;
use crate::session::trajectory::read_regular_file;

/// A line of a trajectory as a witness was told of it.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Told {
    /// Run.
    pub run: String,
    /// Number of the line, from 0.
    pub seq: u64,
    /// Hash of the line.
    pub hash: String,
    /// The moment the line carries, RFC 3339.
    pub at: String,
    /// Machine that told it.
    pub machine: String,
}

/// What stands in the place of a hash where a run was erased because its participant has withdrawn.
const WITHDRAWN: &str = "withdrawn";

impl Told {
    /// That a run is erased at a moment.
    pub(super) fn withdrawal(run: &str, at: &str, machine: &str) -> Told {
        let (run, machine) = (run.to_owned(), machine.to_owned());
        Told { run, seq: 0, hash: WITHDRAWN.to_owned(), at: at.to_owned(), machine }
    }

    /// Whether it tells that the run was erased.
    pub fn is_withdrawal(&self) -> bool {
        self.hash == WITHDRAWN
    }

    /// As a line of a file.
    pub(super) fn text(&self) -> String {
        let mut text = serde_json::to_string(self).unwrap_or_default();
        text.push('\n');
        text
    }
}

/// Everything a witness was told.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WitnessRecord {
    /// By run: the lines of each machine in the order in which it told them, machine after machine.
    pub runs: BTreeMap<String, Vec<Told>>,
    /// Lines that cannot be read: file, and line from 1.
    pub unreadable: Vec<(PathBuf, usize)>,
}

/// Name of the file that one machine's lines of one run stand in.
pub(super) fn file_name(run: &str, machine: &str) -> String {
    format!("{}-{}.jsonl", plain(run), plain(machine))
}

/// A text that cannot lead out of its folder.
fn plain(text: &str) -> String {
    let fits = |letter: char| letter.is_ascii_alphanumeric() || "-_.".contains(letter);
    text.chars().map(|letter| if fits(letter) { letter } else { '_' }).collect()
}

/// Reads what a witness was told.
///
/// # Errors
/// The folder cannot be read.
pub fn read_witness(folder: &Path) -> Result<WitnessRecord, RunError> {
    let entries = std::fs::read_dir(folder).map_err(RunError::io(folder))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "jsonl"));
    paths.sort_unstable();
    let mut record = WitnessRecord::default();
    for path in paths {
        match read_regular_file(&path) {
            Ok(bytes) => record.add(&path, &bytes),
            // One file that somebody has replaced keeps nobody from reading the others.
            Err(_) => record.unreadable.push((path, 1)),
        }
    }
    Ok(record)
}

impl WitnessRecord {
    fn add(&mut self, path: &Path, bytes: &[u8]) {
        for (at, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
            match serde_json::from_slice::<Told>(line) {
                Ok(told) => self.runs.entry(told.run.clone()).or_default().push(told),
                // Between two lines that belong to different connections stands an empty one.
                Err(_) if line.is_empty() => {}
                Err(_) => self.unreadable.push((path.to_owned(), at + 1)),
            }
        }
    }
}
