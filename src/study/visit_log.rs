//! `visits.jsonl` in the folder of runs: who came when, and what became of it, also where no run began.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::definition::Study;
use novamind_record::clock::now;
use novamind_record::files::read_regular_text;
use novamind_record::files::{append_synced, create_folder};
use novamind_session::Machine;

/// Name of the file.
pub const VISITS: &str = "visits.jsonl";

/// Something that happened around the runs of a study.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct VisitLine {
    /// When, RFC 3339.
    pub at: String,
    /// The machine.
    pub machine: String,
    /// Digest of the study's protocol.
    pub study: String,
    /// Label, as it was typed; empty where a code was refused.
    pub label: String,
    /// What happened.
    pub event: VisitEvent,
}

/// What happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VisitEvent {
    /// A participant gave a label that was taken.
    Came,
    /// A label was refused.
    LabelRefused,
    /// The participant does not agree to the text.
    ConsentDeclined,
    /// The practice was passed over.
    PassedPractice,
    /// The participant withdrew; their runs were erased.
    Withdrew,
    /// Everything is done.
    Finished,
    /// A word was given for the experimenter's code and was not it. The line has neither label nor word.
    CodeRefused,
}

/// The list of visits of a machine.
#[derive(Debug, Clone)]
pub(super) struct VisitLog {
    path: PathBuf,
    study: String,
}

impl VisitLog {
    /// The list beside the runs of a machine.
    pub(super) fn of(runs: &Path, study: &Study) -> VisitLog {
        VisitLog { path: runs.join(VISITS), study: study.digest.clone() }
    }

    /// Writes a line. A list that cannot be written keeps nobody from playing: the runs are the record.
    pub(super) fn write(&self, label: &str, event: VisitEvent) {
        let label = label.chars().take(80).collect();
        let line =
            VisitLine { at: now(), machine: Machine::here().id, study: self.study.clone(), label, event };
        let text = serde_json::to_string(&line).unwrap_or_default() + "\n";
        let _ = self
            .path
            .parent()
            .map_or(Ok(()), create_folder)
            .and_then(|()| append_synced(&self.path, text.as_bytes()));
    }

    /// Whether something happened to a participant of this study.
    pub(super) fn has(&self, label: &str, event: VisitEvent) -> bool {
        let lines = visits(&self.path);
        lines.iter().any(|line| line.study == self.study && line.label == label && line.event == event)
    }
}

/// Whether somebody came to a study under a label on the machine with a folder of runs.
pub fn has_come(study: &Study, runs: &Path, label: &str) -> bool {
    VisitLog::of(runs, study).has(label, VisitEvent::Came)
}

/// Records that a word was given for the experimenter's code and was not it.
pub fn record_refused_code(study: &Study, runs: &Path) {
    VisitLog::of(runs, study).write("", VisitEvent::CodeRefused);
}

/// How many came to a study, and what became of them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct VisitSummary {
    /// Labels under which somebody came.
    pub came: usize,
    /// Of them, those who did not agree and have no run.
    pub declined: usize,
    /// Those who withdrew.
    pub withdrew: usize,
    /// Those who finished, and did not withdraw after it.
    pub finished: usize,
    /// Labels that were refused, each time.
    pub refused_labels: usize,
    /// Words that were refused as the experimenter's code.
    pub refused_codes: usize,
}

impl VisitSummary {
    /// Of the lines of all machines, given the labels that have runs.
    pub fn of<'a>(
        lines: impl IntoIterator<Item = &'a VisitLine>,
        with_runs: &BTreeSet<&str>,
    ) -> VisitSummary {
        let mut summary = VisitSummary::default();
        let mut events: BTreeMap<&str, BTreeSet<VisitEvent>> = BTreeMap::new();
        for line in lines {
            match line.event {
                VisitEvent::LabelRefused => summary.refused_labels += 1,
                VisitEvent::CodeRefused => summary.refused_codes += 1,
                event => drop(events.entry(&line.label).or_default().insert(event)),
            }
        }
        summary.came = events.len();
        for (label, events) in events {
            if events.contains(&VisitEvent::Withdrew) {
                summary.withdrew += 1;
            } else if events.contains(&VisitEvent::Finished) {
                summary.finished += 1;
            } else if events.contains(&VisitEvent::ConsentDeclined) && !with_runs.contains(label) {
                summary.declined += 1;
            }
        }
        summary
    }
}

impl fmt::Display for VisitSummary {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let VisitSummary { came, declined, withdrew, finished, refused_labels, refused_codes } = self;
        write!(out, "{came} came: {declined} declined, {withdrew} withdrew, {finished} finished")?;
        write!(
            out,
            ", {} neither · refused: {refused_labels} labels",
            came - declined - withdrew - finished
        )?;
        write!(out, ", {refused_codes} codes")
    }
}

/// Returns the visits that ended with everything done and were not withdrawn, of labels without a run.
pub fn finished_without_run<'a>(
    lines: &'a BTreeSet<VisitLine>,
    with_runs: &BTreeSet<&str>,
) -> Vec<&'a VisitLine> {
    let withdrew =
        |label: &str| lines.iter().any(|line| line.label == label && line.event == VisitEvent::Withdrew);
    let is_finished = |line: &&VisitLine| line.event == VisitEvent::Finished;
    let has_no_run = |line: &&VisitLine| !with_runs.contains(line.label.as_str()) && !withdrew(&line.label);
    lines.iter().filter(is_finished).filter(has_no_run).collect()
}

/// Who came to a study on some machines, each line once: folders may be copies of one another.
pub fn visits_of(study: &Study, machines: &[PathBuf]) -> BTreeSet<VisitLine> {
    let lines = machines.iter().flat_map(|runs| visits(&runs.join(VISITS)));
    lines.filter(|line| line.study == study.digest).collect()
}

/// The lines of a list of visits; those that cannot be read are left out.
pub fn visits(path: &Path) -> Vec<VisitLine> {
    let text = read_regular_text(path);
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}
