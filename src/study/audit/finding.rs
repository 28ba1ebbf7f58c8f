//! Findings of the audit of a study.

use serde::Serialize;

/// A contradiction in the records of a study.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AuditFinding {
    /// Kind of this finding.
    pub kind: FindingKind,
    /// ID of the run; empty if the finding is not about a run.
    pub run: String,
    /// Label of the participant, if known.
    pub participant: Option<String>,
    /// Line of the trajectory, from 1, if the finding is about a line.
    pub line: Option<u64>,
    /// Time of the contradiction, RFC 3339; empty if unknown.
    pub at: String,
    /// Description of the contradiction.
    pub words: String,
}

/// The kind of a finding, in order of severity, most severe first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FindingKind {
    /// The folders contain no run of the study.
    NothingExamined,
    /// A run or its record is missing.
    Missing,
    /// The record of the run is damaged.
    Damaged,
    /// The database or the snapshot contains lines that are missing from the trajectory.
    Cut,
    /// The re-simulation of the run does not reproduce the recorded states.
    NotReached,
    /// Lines could not be appended to the trajectory during the run.
    Unsaved,
    /// The run belongs to a different version of the protocol.
    OtherProtocol,
    /// `run.toml` differs from the first line of the trajectory.
    Manifest,
    /// Participant, seed, condition, rules or consent differ from the study.
    Assignment,
    /// The recorded list of earlier runs does not contain an older run of the participant.
    EarlierRuns,
    /// Hidden state of a session's seed was viewed before the session ended.
    HiddenState,
    /// The clock of the machine was changed during the run.
    Clock,
    /// A participant has more than one session.
    SecondSession,
    /// An archive is not signed by the lab of the study.
    NotSigned,
}

impl FindingKind {
    /// Every kind of finding, most severe first.
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

    /// Returns the name of the kind that reports show.
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
