//! Stamps in the first line of a run that identify its study, lesson and handout.

use serde::{Deserialize, Serialize};

use crate::mode::Mode;

/// The study to which a run belongs, and the assignment of the participant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StudyStamp {
    /// Name of the study, from its protocol.
    pub name: String,
    /// BLAKE3 digest of the study protocol, in hexadecimal digits.
    pub digest: String,
    /// Condition to which the participant was assigned; `None` if the study has no conditions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condition: Option<String>,
    /// Position of the participant in the assignment order, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<u32>,
    /// Whether the run is the practice run of the participant.
    #[serde(default)]
    pub practice: bool,
    /// Number of labels that were rejected before the participant's label was accepted.
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
    /// ID of the earlier run.
    pub run: String,
    /// Mode of the earlier run.
    pub mode: Mode,
    /// Seed of the earlier run.
    pub seed: u64,
    /// Name of the scenario of the earlier run.
    pub scenario: String,
    /// Time at which the earlier run was created, RFC 3339.
    pub created: String,
}

/// The lesson and the part that a run plays.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonStamp {
    /// Name of the lesson files, without the extension.
    pub name: String,
    /// Digest of the plan and texts of the lesson.
    pub digest: String,
    /// Part that the run plays, from 1.
    pub part: u32,
}

/// The handout from which a run started.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandoutStamp {
    /// ID of the class: eight hexadecimal digits.
    pub class: String,
    /// ID of the first run of the handout. Later parts and attempts have their own ids.
    pub run: String,
}

/// Values that a handout sets for a new run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HandoutOptions {
    /// Stamp of the handout for the first line of the run.
    pub stamp: HandoutStamp,
    /// Id that the new run must have; `None` to generate a new id.
    pub run: Option<String>,
}

impl HandoutOptions {
    /// Returns the values for the first run of a handout. This run gets the run id that the handout names.
    pub fn for_first_run(stamp: HandoutStamp) -> HandoutOptions {
        HandoutOptions { run: Some(stamp.run.clone()), stamp }
    }

    /// Returns the values for a later run of the same handout. This run gets a new id.
    pub fn for_later_run(stamp: HandoutStamp) -> HandoutOptions {
        HandoutOptions { stamp, run: None }
    }
}
