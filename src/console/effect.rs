//! What an update asks for: work for the threads behind the screen, and changes of what is shown.

use serde_json::Value;

use super::action::Action;
use super::readings::Reading;
use super::screens::ScreenId;
use super::worker::Recorded;
use crate::glossary::Subject;
use crate::session::{Forecasts, Goal, Mode, NewRun};
use crate::tools::ToolId;
use crate::world::identifiers::Group;

impl Effect {
    /// Whether it would change the run.
    pub fn changes_run(&self) -> bool {
        matches!(
            self,
            Effect::Call { .. }
                | Effect::ConfirmCall { .. }
                | Effect::Undo
                | Effect::Redo
                | Effect::Advance { .. }
                | Effect::SetMemo(_)
        )
    }
}

/// Something an update asks for.
#[derive(Debug, Clone)]
pub enum Effect {
    /// Start a run.
    Create(Box<NewRun>),
    /// Open a run by its id, to go on with it.
    Open(String),
    /// Open a run by its id, to look at it; nothing of it is changed.
    Look(String),
    /// Play a recorded run again.
    Replay {
        /// Which.
        recorded: Recorded,
        /// Where it begins.
        goal: Goal,
        /// New lines are awaited: somebody else is playing it.
        follow: bool,
    },
    /// Go somewhere in the replay.
    Go(Goal),
    /// Go on from this moment of the replay in a run of one's own.
    TakeOver(Mode),
    /// Open the good beginning of a damaged run of the folder as a branch.
    Rescue(String),
    /// What a call would do; only the newest answer counts.
    Check {
        /// Tool.
        tool: ToolId,
        /// Arguments.
        arguments: Value,
    },
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
    /// Ask the database for the person.
    Ask(String),
    /// Ask the database for the rows behind a figure.
    AskBehind(String),
    /// Stop what the person asked.
    CancelQuery,
    /// Ask the database for a screen.
    Read(Reading),
    /// Keep the notes.
    SetMemo(String),
    /// Put text into the clipboard.
    Copy(String),
    /// Show a text to read: its title and the text.
    ShowText(String, String),
    /// Write a file into the folder of the run; its name and contents. A name that is taken gets the next number.
    Write(String, Vec<u8>),
    /// Tell the story of the run for the final page.
    TellStory,
    /// Write the report of the run into its folder.
    WriteReport,
    /// Say something in the last line.
    Say(String),
    /// Say that something was refused.
    Complain(String),
    /// Show a screen.
    Show(ScreenId),
    /// Show the form of a tool.
    ShowTool(ToolId),
    /// Show the form of a tool at the first cell that is for a group, a plan or the like.
    ShowCell(ToolId, String),
    /// Show the form of a tool with these arguments typed into it; none are with `Null`.
    Prefill {
        /// Tool.
        tool: ToolId,
        /// Arguments.
        arguments: Value,
    },
    /// Show a thread in the inbox, by its number.
    ShowThread(u32),
    /// Show a group on a screen that opens groups.
    ShowGroup(ScreenId, Group),
    /// Put a statement into the SQL editor.
    EditSql(String),
    /// Put a statement into the SQL editor and run it.
    RunSql(String),
    /// Save a statement into the person's own queries.
    SaveQuery {
        /// Name of its file.
        name: String,
        /// Title, if the statement has none.
        title: String,
        /// Statement.
        sql: String,
    },
    /// Ask once before a call that cannot be taken back.
    ConfirmCall {
        /// Tool.
        tool: ToolId,
        /// Arguments.
        arguments: Value,
        /// What it means.
        text: String,
    },
    /// Explain something over what is open.
    Explain(Subject),
    /// Start a run for practice with the tour in it.
    StartTour,
    /// How a run of the folder went.
    ReadCourse(String),
    /// Give up a run of the folder.
    EndRun(String),
    /// Delete a run of the folder.
    DeleteRun(String),
    /// Save and leave, whatever is half typed.
    LeaveNow,
    /// Do what a key would do.
    Do(Action),
}
