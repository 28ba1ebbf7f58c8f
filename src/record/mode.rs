//! Modes of a run.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The purpose of a run. The mode is recorded and cannot be changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// A human baseline session, with the tools and information of agents.
    Baseline,
    /// A run for the player's experiments.
    Sandbox,
    /// A run of a lesson.
    Lesson,
    /// A run for testing and debugging the mechanics, with access to hidden state.
    Debug,
}

impl Mode {
    /// All modes, in declaration order.
    pub const ALL: [Mode; 4] = [Mode::Baseline, Mode::Sandbox, Mode::Lesson, Mode::Debug];

    /// The modes that a user can choose for a new run. A lesson run always has the lesson mode.
    pub const SELECTABLE: [Mode; 3] = [Mode::Baseline, Mode::Sandbox, Mode::Debug];

    /// Returns the default mode of a branch. A branch is never a baseline run and never belongs to a lesson.
    pub fn branch_mode(self) -> Mode {
        if matches!(self, Mode::Baseline | Mode::Lesson) { Mode::Sandbox } else { self }
    }

    /// Returns the name that options and manifests use for the mode.
    pub fn id(self) -> &'static str {
        match self {
            Mode::Baseline => "baseline",
            Mode::Sandbox => "sandbox",
            Mode::Lesson => "lesson",
            Mode::Debug => "debug",
        }
    }

    /// Returns the mode with this name, if it exists.
    pub fn parse(id: &str) -> Option<Mode> {
        Mode::ALL.into_iter().find(|mode| mode.id() == id)
    }

    /// Returns a one-line description of the purpose of the mode.
    pub fn purpose(self) -> &'static str {
        match self {
            Mode::Baseline => "human baseline session: the tools of agents, complete record",
            Mode::Sandbox => "free experiments",
            Mode::Lesson => "learning",
            Mode::Debug => "work on the mechanics: hidden state, single days, changed parameters",
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.id())
    }
}
