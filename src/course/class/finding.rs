//! Problems with submissions, which are reported to the instructor.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// A problem with the submissions of a class.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum ClassFinding {
    /// A file that cannot be read: damaged, altered, or not a run.
    Unreadable {
        /// Label of the student in the path, if any.
        label: Option<String>,
        /// Path of the file.
        path: PathBuf,
        /// Reason why the file cannot be read.
        problem: String,
    },
    /// A run whose events do not match the re-simulation.
    Altered {
        /// Label of the student.
        label: String,
        /// Name of the run.
        run: String,
        /// The first event that does not match.
        problem: String,
    },
    /// Records of one run that contradict each other.
    Conflicting {
        /// Label of the student.
        label: String,
        /// Name of the run.
        run: String,
        /// Where the contradicting records were found.
        paths: Vec<PathBuf>,
    },
    /// A run of a different lesson, or of a different version of the lesson.
    OtherLesson {
        /// Label of the student.
        label: String,
        /// Name of the run.
        run: String,
    },
    /// A run that did not start from this student's handout.
    OtherHandout {
        /// Label of the student.
        label: String,
        /// Name of the run.
        run: String,
        /// Label of the student whose handout was used; `None` if the student's own handout was used but the past of
        /// the run differs from it.
        of: Option<String>,
    },
    /// A run of the lesson that did not start from a handout of this class.
    Unknown {
        /// Label in the first event of the run.
        label: Option<String>,
        /// Name of the run.
        run: String,
        /// Path of the run.
        path: PathBuf,
    },
    /// A student who submitted no run.
    Missing {
        /// Label of the student.
        label: String,
    },
    /// A student with unfinished parts of the lesson.
    NotFinished {
        /// Label of the student.
        label: String,
        /// Numbers of the unfinished parts, counted from 1.
        parts: Vec<u32>,
    },
    /// A changed handout in the folder of the class.
    AlteredHandout {
        /// Label of the student.
        label: String,
    },
}

impl ClassFinding {
    /// Returns the label of the student, or `None` if the student is unknown.
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
