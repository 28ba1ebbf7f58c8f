//! What an audit found.

use serde::Serialize;

/// Something that an honest session does not leave behind.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AuditFinding {
    /// What kind of thing it is.
    pub kind: AuditKind,
    /// Run; empty if the finding belongs to none.
    pub run: String,
    /// Label of the participant, where it is known.
    pub participant: Option<String>,
    /// Line of the trajectory, from 1, where it belongs to one.
    pub line: Option<u64>,
    /// Moment it belongs to, RFC 3339; empty where none is known.
    pub at: String,
    /// In words.
    pub words: String,
}

/// Kinds of findings, the gravest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AuditKind {
    /// No run of the study is in the folders.
    NothingExamined,
    /// The record is not there any more.
    Missing,
    /// The record is damaged.
    Damaged,
    /// The database or the snapshot holds lines that the trajectory lacks.
    Cut,
    /// The states that are recorded are not reached again.
    NotReached,
    /// Lines could not be written while the run was played.
    Unsaved,
    /// The run belongs to another version of the protocol.
    OtherProtocol,
    /// `run.toml` was edited.
    Manifest,
    /// Participant, seed, condition or rules are not those of the study.
    Assignment,
    /// The list of earlier runs is not what the machine knows.
    EarlierRuns,
    /// Hidden state of a session's seed was viewed before the session was over.
    HiddenState,
    /// The clock of the machine was set.
    Clock,
    /// A participant has two sessions.
    SecondSession,
    /// An archive does not carry the signature of the lab.
    NotSigned,
}

impl AuditKind {
    /// Every kind, the gravest first.
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

    /// In words.
    pub fn title(self) -> &'static str {
        match self {
            AuditKind::NothingExamined => "nothing examined",
            AuditKind::Missing => "record missing",
            AuditKind::Damaged => "record damaged",
            AuditKind::Cut => "lines cut",
            AuditKind::NotReached => "states not reached again",
            AuditKind::Unsaved => "lines not saved",
            AuditKind::OtherProtocol => "other protocol",
            AuditKind::Manifest => "run.toml edited",
            AuditKind::Assignment => "not as assigned",
            AuditKind::EarlierRuns => "earlier runs edited",
            AuditKind::HiddenState => "hidden state viewed",
            AuditKind::Clock => "clock set",
            AuditKind::SecondSession => "second session",
            AuditKind::NotSigned => "archive not signed",
        }
    }
}
