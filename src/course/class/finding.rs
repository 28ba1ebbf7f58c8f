//! What an instructor should know of what came back.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// Something that an instructor should know of what came back.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum ClassFinding {
    /// A file that cannot be read: damaged, altered, or no run.
    Unreadable {
        /// The student whom its place names, if it names one.
        label: Option<String>,
        /// Where it lies.
        path: PathBuf,
        /// Why.
        problem: String,
    },
    /// A run whose lines are not what the simulation makes of them.
    Altered {
        /// Label.
        label: String,
        /// Run.
        run: String,
        /// The first line that does not fit.
        problem: String,
    },
    /// Records of one run that contradict each other.
    Twice {
        /// Label.
        label: String,
        /// Run.
        run: String,
        /// Where they lie.
        paths: Vec<PathBuf>,
    },
    /// A run that was played by another lesson, or another version of it.
    OtherLesson {
        /// Label.
        label: String,
        /// Run.
        run: String,
    },
    /// A run that began with another hand-out than this student's.
    OtherHandout {
        /// Label.
        label: String,
        /// Run.
        run: String,
        /// Whose hand-out it was; none where only its past differs.
        of: Option<String>,
    },
    /// A run of the lesson that did not begin with a hand-out of this class.
    Unknown {
        /// Label in its first line.
        label: Option<String>,
        /// Run.
        run: String,
        /// Where it lies.
        path: PathBuf,
    },
    /// A student of whom nothing came back.
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
    /// A hand-out in the folder of the class that is not the one that was handed out.
    AlteredHandout {
        /// Label.
        label: String,
    },
}

impl ClassFinding {
    /// The student it is about.
    pub fn label(&self) -> Option<&str> {
        match self {
            ClassFinding::Unreadable { label, .. } | ClassFinding::Unknown { label, .. } => label.as_deref(),
            ClassFinding::Altered { label, .. }
            | ClassFinding::Twice { label, .. }
            | ClassFinding::OtherLesson { label, .. }
            | ClassFinding::OtherHandout { label, .. }
            | ClassFinding::Missing { label }
            | ClassFinding::NotFinished { label, .. }
            | ClassFinding::AlteredHandout { label } => Some(label),
        }
    }
}
