//! Findings of an audit.

use serde::Serialize;

/// A contradiction that an honest session does not cause.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AuditFinding {
    /// Kind of finding.
    pub kind: AuditKind,
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
pub enum AuditKind {
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

impl AuditKind {
    /// Every kind, most severe first.
    pub const ALL: [AuditKind; 14] = [
        AuditKind::NothingExamined,
        AuditKind::Missing,
        AuditKind::Damaged,
        AuditKind::Cut,
        AuditKind::NotReached,
        AuditKind::Unsaved,
        AuditKind::OtherProtocol,
        AuditKind::Manifest,
        AuditKind::Assignment,
        AuditKind::EarlierRuns,
        AuditKind::HiddenState,
        AuditKind::Clock,
        AuditKind::SecondSession,
        AuditKind::NotSigned,
    ];

    /// Returns the name for reports.
    pub fn title(self) -> &'static str {
        match self {
            AuditKind::NothingExamined => "nothing examined",
            AuditKind::Missing => "record missing",
            AuditKind::Damaged => "record damaged",
            AuditKind::Cut => "lines cut",
            AuditKind::NotReached => "states not reproduced",
            AuditKind::Unsaved => "lines not saved",
            AuditKind::OtherProtocol => "other protocol",
            AuditKind::Manifest => "run.toml edited",
            AuditKind::Assignment => "not as assigned",
            AuditKind::EarlierRuns => "earlier runs edited",
            AuditKind::HiddenState => "hidden state viewed",
            AuditKind::Clock => "clock changed",
            AuditKind::SecondSession => "second session",
            AuditKind::NotSigned => "archive not signed",
        }
    }
}
