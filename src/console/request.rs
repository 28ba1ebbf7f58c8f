//! What the screen asks of the run and of the folder of runs: work for the thread that owns the session.

use std::path::PathBuf;

use serde_json::Value;

use crate::session::{Access, Forecasts, Goal, Mode, NewRun};
use crate::tools::ToolId;

/// Work that a person asked for.
#[derive(Debug, Clone)]
pub enum Request {
    /// List the runs of the folder.
    ListRuns,
    /// Tell how a run of the folder went.
    PreviewRun(String),
    /// Give up a run of the folder.
    EndRun(String),
    /// Delete a run of the folder.
    DeleteRun(String),
    /// Start a run in the folder.
    Create(Box<NewRun>),
    /// Open a run of the folder by its id, to go on with it or to look at it.
    Open(String, Access),
    /// Open the good beginning of a damaged run of the folder as a branch.
    Rescue(String),
    /// Play a recorded run again.
    Replay {
        /// Which.
        recorded: Recorded,
        /// Where it begins.
        goal: Goal,
        /// New lines are awaited: somebody else is playing it.
        follow: bool,
    },
    /// Go on from this moment of the replay in a run of one's own.
    TakeOver(Mode),
    /// Call a tool.
    Call {
        /// Tool.
        tool: ToolId,
        /// Arguments.
        arguments: Value,
    },
    /// Take back the last setting.
    Undo,
    /// Set again what the last undo took back.
    Redo,
    /// Let the week pass.
    Advance {
        /// Why.
        rationale: String,
        /// Forecasts of cash.
        forecasts: Forecasts,
    },
    /// Keep the notes.
    SetMemo(String),
    /// Tell the story of the run for the final page.
    TellStory,
    /// Put the report of the run into words.
    WriteReport,
}

/// A run that was recorded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Recorded {
    /// One of the folder of runs, by its id.
    Run(String),
    /// A folder of a run or a trajectory file anywhere.
    File(PathBuf),
}

impl Request {
    /// Whether it would change the run.
    pub fn changes_run(&self) -> bool {
        self.waits_for_week() || matches!(self, Request::Advance { .. } | Request::SetMemo(_))
    }

    /// Whether it is refused while a week runs: it was meant for the company as it was before.
    pub fn waits_for_week(&self) -> bool {
        matches!(self, Request::Call { .. } | Request::Undo | Request::Redo)
    }

    /// What the screen is busy with until it is answered; none where the person goes on meanwhile.
    pub fn busy_with(&self) -> Option<&'static str> {
        Some(match self {
            Request::Create(_) => "starting the run",
            Request::Open(..) => "opening the run",
            Request::Rescue(_) => "opening the intact part of the run",
            Request::Replay { .. } => "opening the record",
            Request::TakeOver(_) => "starting a run from here",
            Request::Advance { .. } => "the week runs",
            _ => return None,
        })
    }
}
