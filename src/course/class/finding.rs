//! Problems of a collection that the instructor should know.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// A problem of a collection.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum ClassFinding {
    /// A file that cannot be read: damaged, altered, or not a run.
    Unreadable {
        /// Label that the path names, if any.
        label: Option<String>,
        /// Path.
        path: PathBuf,
        /// Reason.
        problem: String,
    },
    /// A run whose events do not match the re-simulation.
    Altered {
        /// Label.
        label: String,
        /// Run.
        run: String,
        /// The first event that does not match.
        problem: String,
    },
    /// Records of one run that contradict each other.
    Conflicting {
        /// Label.
        label: String,
        /// Run.
        run: String,
        /// Their paths.
        paths: Vec<PathBuf>,
    },
    /// A run of another lesson, or of another version of it.
    OtherLesson {
        /// Label.
        label: String,
        /// Run.
        run: String,
    },
    /// A run that did not start from this student's handout.
    OtherHandout {
        /// Label.
        label: String,
        /// Run.
        run: String,
        /// Label of the handout's student; `None` if only the past differs.
        of: Option<String>,
    },
    /// A run of the lesson that did not start from a handout of this class.
    Unknown {
        /// Label in its first event.
        label: Option<String>,
        /// Run.
        run: String,
        /// Path.
        path: PathBuf,
    },
    /// A student without a submission.
    Missing {
        /// Label.
        label: String,
    },
    /// A student who has not finished every part.
    NotFinished {
        /// Label.
        label: String,
        /// The parts, counted from 1.
        parts: Vec<u32>,
    },
    /// A handout in the folder of the class that was changed.
    AlteredHandout {
        /// Label.
        label: String,
    },
}

impl ClassFinding {
    /// Returns the label of the student, if known.
    pub fn label(&self) -> Option<&str> {
        match self {
            ClassFinding::Unreadable { label, .. } | ClassFinding::Unknown { label, .. } => label.as_deref(),
            ClassFinding::Altered { label, .. }
            | ClassFinding::Conflicting { label, .. }
            | ClassFinding::OtherLesson { label, .. }
            | ClassFinding::OtherHandout { label, .. }
            | ClassFinding::Missing { label }
            | ClassFinding::NotFinished { label, .. }
            | ClassFinding::AlteredHandout { label } => Some(label),
        }
    }
}
