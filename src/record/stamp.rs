//! What the first line of a run says of the study, the lesson and the hand-out that it belongs to.

use serde::{Deserialize, Serialize};

use crate::mode::Mode;

/// The study, and the place of this person in it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StudyStamp {
    /// Name of the study.
    pub name: String,
    /// blake3 digest of its protocol, in hexadecimal digits.
    pub digest: String,
    /// Condition the person was assigned to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condition: Option<String>,
    /// Place of the person in the assignment, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<u32>,
    /// This is the practice, not the session.
    #[serde(default)]
    pub practice: bool,
    /// Labels that were refused before this one was taken.
    #[serde(default)]
    pub refused_labels: u32,
}

#[cfg(any(test, feature = "test-kit"))]
impl StudyStamp {
    /// That of a pilot in which nobody is assigned to anything.
    pub fn pilot(practice: bool) -> StudyStamp {
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

/// An earlier run of the same person.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EarlierRun {
    /// Run.
    pub run: String,
    /// Its mode.
    pub mode: Mode,
    /// Its seed.
    pub seed: u64,
    /// Its scenario.
    pub scenario: String,
    /// When it was created, RFC 3339.
    pub created: String,
}

/// Which lesson a run belongs to, as its first line says.
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

/// Which hand-out of a class a run began with, as its first line says.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandoutStamp {
    /// Name of the class: eight hexadecimal digits.
    pub class: String,
    /// The run that the hand-out begins; later parts and tries have names of their own.
    pub run: String,
}

/// What a hand-out lays down for a new run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HandoutEntry {
    /// The hand-out.
    pub stamp: HandoutStamp,
    /// Name of the run; one of its own where the hand-out names another.
    pub run: Option<String>,
}

impl HandoutEntry {
    /// For the run that a hand-out begins.
    pub fn of_first_run(stamp: HandoutStamp) -> HandoutEntry {
        HandoutEntry { run: Some(stamp.run.clone()), stamp }
    }

    /// For a run that follows the one that the hand-out begins.
    pub fn of_later_run(stamp: HandoutStamp) -> HandoutEntry {
        HandoutEntry { stamp, run: None }
    }
}
