//! `visits.jsonl` in the folder of runs: the visits of participants with their outcomes, including visits in
//! which no run was played.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::definition::Study;
use novamind_record::clock::now;
use novamind_record::files::read_regular_text_or_empty;
use novamind_record::files::{append_synced, create_folder};
use novamind_session::Machine;

/// Name of the file that contains the list of visits.
pub const VISITS_FILE: &str = "visits.jsonl";

/// A line of the list of visits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct VisitLine {
    /// Time of the event, RFC 3339.
    pub at: String,
    /// Identifier of the machine.
    pub machine: String,
    /// Digest of the study's protocol.
    pub study: String,
    /// Label as typed; empty for a rejected code.
    pub label: String,
    /// Event of the visit.
    pub event: VisitEvent,
}

/// An event of a visit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VisitEvent {
    /// A participant entered a valid label.
    Came,
    /// A label that is not valid for the study was entered.
    LabelRefused,
    /// The participant declined consent.
    ConsentDeclined,
    /// The participant skipped the practice run.
    PassedPractice,
    /// The participant withdrew, and the participant's runs were erased.
    Withdrew,
    /// The participant completed the study.
    Finished,
    /// A wrong code was entered instead of the experimenter's code. The line contains neither a label nor the code.
    CodeRefused,
}

/// The list of visits of a machine.
#[derive(Debug, Clone)]
pub(super) struct VisitLog {
    path: PathBuf,
    study: String,
}

impl VisitLog {
    /// Returns the list of visits in a machine's folder of runs.
    pub(super) fn new(runs: &Path, study: &Study) -> VisitLog {
        VisitLog { path: runs.join(VISITS_FILE), study: study.digest.clone() }
    }

    /// Appends an event to the list of visits. Write errors are ignored, because the runs contain the record
    /// of the study.
    pub(super) fn append(&self, label: &str, event: VisitEvent) {
        let label = label.chars().take(80).collect();
        let line =
            VisitLine { at: now(), machine: Machine::current().id, study: self.study.clone(), label, event };
        let text = serde_json::to_string(&line).unwrap_or_default() + "\n";
        let _ = self
            .path
            .parent()
            .map_or(Ok(()), create_folder)
            .and_then(|()| append_synced(&self.path, text.as_bytes()));
    }

    /// Returns whether the list contains this event for a participant of the study.
    pub(super) fn contains(&self, label: &str, event: VisitEvent) -> bool {
        let lines = read_visits(&self.path);
        lines.iter().any(|line| line.study == self.study && line.label == label && line.event == event)
    }
}

/// Returns whether the list in a folder of runs contains a visit of a label to a study.
pub fn has_visited(study: &Study, runs: &Path, label: &str) -> bool {
    VisitLog::new(runs, study).contains(label, VisitEvent::Came)
}

/// Records that a wrong code was entered instead of the experimenter's code.
pub(super) fn record_rejected_code(study: &Study, runs: &Path) {
    VisitLog::new(runs, study).append("", VisitEvent::CodeRefused);
}

/// Number of participants who visited a study, by outcome.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct VisitSummary {
    /// Number of labels that have at least one visit.
    pub came: usize,
    /// Number of labels that declined consent and have no run.
    pub declined: usize,
    /// Number of labels that withdrew.
    pub withdrew: usize,
    /// Number of labels that completed the study and did not withdraw.
    pub finished: usize,
    /// Number of rejected label entries, including repetitions.
    pub refused_labels: usize,
    /// Number of rejected code entries.
    pub refused_codes: usize,
}

impl VisitSummary {
    /// Summarizes the lists of visits of all machines. `with_runs` contains the labels that have runs.
    pub fn from_lines<'a>(
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
            ", {} in progress or left · rejected: {refused_labels} labels",
            came - declined - withdrew - finished
        )?;
        write!(out, ", {refused_codes} codes")
    }
}

/// Returns the visits in which a participant completed the study, for labels that have no run and did not
/// withdraw.
pub fn finished_visits_without_run<'a>(
    lines: &'a BTreeSet<VisitLine>,
    with_runs: &BTreeSet<&str>,
) -> Vec<&'a VisitLine> {
    let withdrew =
        |label: &str| lines.iter().any(|line| line.label == label && line.event == VisitEvent::Withdrew);
    let is_finished = |line: &&VisitLine| line.event == VisitEvent::Finished;
    let has_no_run = |line: &&VisitLine| !with_runs.contains(line.label.as_str()) && !withdrew(&line.label);
    lines.iter().filter(is_finished).filter(has_no_run).collect()
}

/// Returns the visits to a study on the given machines. A line that occurs in several copies of a folder is
/// returned once.
pub fn read_study_visits(study: &Study, machines: &[PathBuf]) -> BTreeSet<VisitLine> {
    let lines = machines.iter().flat_map(|runs| read_visits(&runs.join(VISITS_FILE)));
    lines.filter(|line| line.study == study.digest).collect()
}

/// Reads the lines of `visits.jsonl`. Skips lines that cannot be parsed.
pub fn read_visits(path: &Path) -> Vec<VisitLine> {
    let text = read_regular_text_or_empty(path);
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}
