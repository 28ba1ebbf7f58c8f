//! `worlds.jsonl` in the folder of runs of a machine: every world that was opened on it, by whatever command, so that a
//! rehearsal of a session is noticed.
//!
//! Each line names the hash of the one before, and every sitting of a run records how long the list was and how it ended:
//! a list that was cut or edited contradicts the runs.

use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{PoisonError, RwLock};

use serde::{Deserialize, Serialize};

use crate::session::play::machine::Machine;
use crate::session::trajectory::record::WorldsSeen;
use crate::session::trajectory::{append_to_regular_file, now, read_regular_text};

/// Name of the file.
pub const WORLDS: &str = "worlds.jsonl";

/// A world that was opened.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WorldLine {
    /// When, RFC 3339.
    pub at: String,
    /// The machine.
    pub machine: String,
    /// By what: `play`, `run`, `lab`, `branch`, `rescue`, `import`, `replay`, `delete`.
    pub by: String,
    /// First seed.
    pub seed: u64,
    /// Last seed, of commands that play a range.
    pub to_seed: u64,
    /// Scenario.
    pub scenario: String,
    /// Run, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<String>,
    /// Digest of the study's protocol, where the run belongs to one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub study: Option<String>,
    /// Hash of the line before.
    pub prev: String,
}

/// A list that was read.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WorldLog {
    /// Its lines.
    pub lines: Vec<WorldLine>,
    /// Hash of each, 16 digits.
    pub heads: Vec<String>,
    /// Line, from 1, that does not follow from the one before.
    pub broken_at: Option<u64>,
}

static PLACE: RwLock<Option<PathBuf>> = RwLock::new(None);

/// Keeps the list of this process in a folder of runs. Without it nothing is listed.
pub fn list_worlds_in(runs: &Path) {
    *PLACE.write().unwrap_or_else(PoisonError::into_inner) = Some(runs.join(WORLDS));
}

/// Whether the experimenter's code was given.
static BY_EXPERIMENTER: AtomicBool = AtomicBool::new(false);

/// What is opened from now on is opened by the experimenter, who has given the code.
pub fn list_worlds_as_experimenter() {
    BY_EXPERIMENTER.store(true, Ordering::Relaxed);
}

/// What stands before the command in lines of the experimenter.
pub(in crate::session) const EXPERIMENTER: &str = "experimenter: ";

fn place() -> Option<PathBuf> {
    PLACE.read().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Lists a world that is opened. A list that cannot be written keeps nobody from playing.
pub fn list_world(by: &str, seeds: (u64, u64), scenario: &str, run: Option<&str>, study: Option<&str>) {
    let Some(path) = place() else { return };
    let line = WorldLine {
        at: now(),
        machine: Machine::here().id,
        by: match BY_EXPERIMENTER.load(Ordering::Relaxed) {
            true => format!("{EXPERIMENTER}{by}"),
            false => by.to_owned(),
        },
        seed: seeds.0,
        to_seed: seeds.1,
        scenario: scenario.to_owned(),
        run: run.map(str::to_owned),
        study: study.map(str::to_owned),
        prev: String::new(),
    };
    let _ = append(&path, line);
}

fn append(path: &Path, line: WorldLine) -> std::io::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let mut file = append_to_regular_file(path)?;
    // Two programs at once write one after the other.
    file.lock()?;
    let mut text = String::new();
    file.seek(SeekFrom::Start(0))?;
    file.read_to_string(&mut text)?;
    let line = WorldLine { prev: last_head(&text), ..line };
    let text = serde_json::to_string(&line).unwrap_or_default() + "\n";
    file.write_all(text.as_bytes())
}

fn head_of(line: &str) -> String {
    blake3::hash(line.as_bytes()).to_hex()[..16].to_owned()
}

/// How a list ends; empty where there is none.
fn last_head(text: &str) -> String {
    text.lines().last().map(head_of).unwrap_or_default()
}

/// How long the list of this process is now, and how it ends; none where none is kept.
pub(in crate::session) fn worlds_seen() -> Option<WorldsSeen> {
    let text = read_regular_text(&place()?);
    Some(WorldsSeen { lines: text.lines().count() as u64, head: last_head(&text) })
}

impl WorldLog {
    /// Reads a list; a missing one is empty.
    pub fn read(path: &Path) -> WorldLog {
        let text = read_regular_text(path);
        let mut log = WorldLog::default();
        let mut prev = String::new();
        for (at, text) in text.lines().enumerate() {
            let line: Option<WorldLine> = serde_json::from_str(text).ok();
            let follows = line.as_ref().is_some_and(|line| line.prev == prev);
            if !follows && log.broken_at.is_none() {
                log.broken_at = Some(at as u64 + 1);
            }
            prev = head_of(text);
            log.heads.push(prev.clone());
            log.lines.extend(line);
        }
        log
    }

    /// Whether the list still holds what a sitting saw of it.
    pub fn holds(&self, seen: &WorldsSeen) -> bool {
        match seen.lines.checked_sub(1) {
            None => true,
            Some(last) => self.heads.get(last as usize) == Some(&seen.head),
        }
    }
}
