//! Findings of an audit.

use serde::Serialize;

/// A contradiction that an honest session does not cause.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AuditFinding {
    /// Kind of finding.
    pub kind: FindingKind,
    /// Run; empty if the finding is not about a run.
    pub run: String,
    /// Label of the participant, if known.
    pub participant: Option<String>,
    /// Line of the trajectory, from 1, if the finding is about a line.
    pub line: Option<u64>,
    /// Time, RFC 3339; empty if unknown.
    pub at: String,
    /// Description.
    pub words: String,
}

/// The kind of a finding, in order of severity, most severe first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FindingKind {
    /// The folders contain no run of the study.
    NothingExamined,
    /// The record is missing.
    Missing,
    /// The record is damaged.
    Damaged,
    /// The database or the snapshot contains lines that the trajectory lacks.
    Cut,
    /// Simulation does not reproduce the recorded states.
    NotReached,
    /// Lines could not be appended to the trajectory during the run.
    Unsaved,
    /// The run belongs to another version of the protocol.
    OtherProtocol,
    /// `run.toml` was edited.
    Manifest,
    /// Participant, seed, condition, rules or consent differ from the study.
    Assignment,
    /// The recorded list of earlier runs lacks a run of the machine.
    EarlierRuns,
    /// Hidden state of a session's seed was viewed before the session ended.
    HiddenState,
    /// The clock of the machine was changed.
    Clock,
    /// A participant has two sessions.
    SecondSession,
    /// An archive is not signed by the lab.
    NotSigned,
}

impl FindingKind {
    /// Every kind, most severe first.
    pub const ALL: [FindingKind; 14] = [
        FindingKind::NothingExamined,
        FindingKind::Missing,
        FindingKind::Damaged,
        FindingKind::Cut,
        FindingKind::NotReached,
        FindingKind::Unsaved,
        FindingKind::OtherProtocol,
        FindingKind::Manifest,
        FindingKind::Assignment,
        FindingKind::EarlierRuns,
        FindingKind::HiddenState,
        FindingKind::Clock,
        FindingKind::SecondSession,
        FindingKind::NotSigned,
    ];

    /// Returns the name for reports.
    pub fn title(self) -> &'static str {
        match self {
            FindingKind::NothingExamined => "nothing examined",
            FindingKind::Missing => "record missing",
            FindingKind::Damaged => "record damaged",
            FindingKind::Cut => "lines cut",
            FindingKind::NotReached => "states not reproduced",
            FindingKind::Unsaved => "lines not saved",
            FindingKind::OtherProtocol => "other protocol",
            FindingKind::Manifest => "run.toml edited",
            FindingKind::Assignment => "not as assigned",
            FindingKind::EarlierRuns => "earlier runs edited",
            FindingKind::HiddenState => "hidden state viewed",
            FindingKind::Clock => "clock changed",
            FindingKind::SecondSession => "second session",
            FindingKind::NotSigned => "archive not signed",
        }
    }
}
