//! Stamps of the study, lesson and handout of a run in its first line.

use serde::{Deserialize, Serialize};

use crate::mode::Mode;

/// The study of a run, and the assignment of the participant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StudyStamp {
    /// Name of the study.
    pub name: String,
    /// BLAKE3 digest of its protocol, in hexadecimal digits.
    pub digest: String,
    /// Assigned condition.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condition: Option<String>,
    /// Position in the assignment, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<u32>,
    /// Whether this is the practice run.
    #[serde(default)]
    pub practice: bool,
    /// Number of labels that were rejected before this one was accepted.
    #[serde(default)]
    pub refused_labels: u32,
}

impl StudyStamp {
    /// Returns the stamp of a pilot study without conditions.
    #[cfg(any(test, feature = "test-kit"))]
    pub fn pilot_study(practice: bool) -> StudyStamp {
        StudyStamp {
            name: "pilot".to_owned(),
            digest: String::new(),
            condition: None,
            order: None,
            practice,
            refused_labels: 0,
        }
    }
}

/// An earlier run of the same participant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EarlierRun {
    /// Id of the run.
    pub run: String,
    /// Mode.
    pub mode: Mode,
    /// Seed.
    pub seed: u64,
    /// Scenario.
    pub scenario: String,
    /// Moment of creation, RFC 3339.
    pub created: String,
}

/// The lesson of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonStamp {
    /// Name of the lesson.
    pub name: String,
    /// Digest of its plan and texts.
    pub digest: String,
    /// The part, counted from 1.
    pub part: u32,
}

/// The handout from which a run started.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandoutStamp {
    /// Id of the class: eight hexadecimal digits.
    pub class: String,
    /// Id of the first run of the handout. Later parts and attempts have their own ids.
    pub run: String,
}

/// Values that a handout sets for a new run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HandoutEntry {
    /// The handout.
    pub stamp: HandoutStamp,
    /// Id of the run; `None` for a new id.
    pub run: Option<String>,
}

impl HandoutEntry {
    /// Returns the values for the first run of a handout.
    pub fn for_first_run(stamp: HandoutStamp) -> HandoutEntry {
        HandoutEntry { run: Some(stamp.run.clone()), stamp }
    }

    /// Returns the values for a later run of the same handout.
    pub fn for_later_run(stamp: HandoutStamp) -> HandoutEntry {
        HandoutEntry { stamp, run: None }
    }
}
