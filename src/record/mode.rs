//! What a run is for, and what it allows.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Mode of a run; it is recorded and cannot be changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// A human baseline session: exactly what agents have.
    Baseline,
    /// For trying things out.
    Sandbox,
    /// For lessons.
    Lesson,
    /// For work on the mechanics: hidden state can be seen.
    Debug,
}

impl Mode {
    /// Every mode that a run can have.
    pub const ALL: [Mode; 4] = [Mode::Baseline, Mode::Sandbox, Mode::Lesson, Mode::Debug];

    /// The modes of new runs. There are no lessons yet; runs that were recorded as one are read and played on.
    pub const OFFERED: [Mode; 3] = [Mode::Baseline, Mode::Sandbox, Mode::Debug];

    /// The mode of a branch of a run of this mode, unless another is asked for: no branch is a baseline, and none belongs to a lesson.
    pub fn of_branch(self) -> Mode {
        if matches!(self, Mode::Baseline | Mode::Lesson) { Mode::Sandbox } else { self }
    }

    /// Word as options and manifests write it.
    pub fn id(self) -> &'static str {
        match self {
            Mode::Baseline => "baseline",
            Mode::Sandbox => "sandbox",
            Mode::Lesson => "lesson",
            Mode::Debug => "debug",
        }
    }

    /// The mode with this word.
    pub fn parse(id: &str) -> Option<Mode> {
        Mode::ALL.into_iter().find(|mode| mode.id() == id)
    }

    /// What the mode is for, in a line.
    pub fn purpose(self) -> &'static str {
        match self {
            Mode::Baseline => "a human baseline session: exactly what agents have, complete record",
            Mode::Sandbox => "trying things out",
            Mode::Lesson => "learning",
            Mode::Debug => "work on the mechanics: hidden state, single days, other parameters",
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.id())
    }
}
