//! What an update asks for: work for the threads behind the screen, and changes of what is shown.

use serde_json::Value;

use super::action::Action;
use super::context::{Figure, ScreenId};
use novamind_glossary::Subject;
use novamind_session::Goal;
use novamind_session::identifiers::Group;
use novamind_study::Study;
use novamind_tools::ToolId;
use novamind_worker::asking::Ask;
use novamind_worker::readings::Reading;
use novamind_worker::request::{Recorded, Request};

impl Effect {
    /// Whether it would change the run.
    pub fn changes_run(&self) -> bool {
        match self {
            Effect::Request(request) => request.changes_run(),
            Effect::ConfirmCall { .. }
            | Effect::ConfirmCalls { .. }
            | Effect::ConfirmWords(_)
            | Effect::SendWords(_) => true,
            _ => false,
        }
    }

    /// A call of a tool.
    pub fn call(tool: ToolId, arguments: Value) -> Effect {
        Effect::Request(Request::Call { tool, arguments })
    }
}

/// Something an update asks for.
#[derive(Debug, Clone)]
pub enum Effect {
    /// Work for the thread that owns the session.
    Request(Request),
    /// Play a recorded run again from a moment on, and show its hidden state.
    ReplayInside(Recorded, Goal),
    /// Follow a run that somebody else plays, drawn to be read from far away.
    Project(Recorded),
    /// Go somewhere in the replay.
    Go(Goal),
    /// Ask the worker; the page that asks keeps what waits for the answer.
    Ask(Ask),
    /// A text of the screen was sent: its place, as the record names it.
    SentText(&'static str),
    /// Find out why a figure of a week changed.
    AskWhy(Figure),
    /// Show the rows behind a figure.
    ShowRows(Figure),
    /// Close whatever lies over the screen.
    CloseDialogs,
    /// Show the curve of a group, of the first known one if none is named.
    ShowCurve(Option<Group>),
    /// Show the page of the opponents.
    ShowOpponents,
    /// Leave what is open, after a question where text would be lost, and open another run of the folder by its id.
    OpenRun(String),
    /// Ask once before words that set a parameter of the run.
    ConfirmWords(String),
    /// Send these words, which set a parameter of the run, from the X-ray screen.
    SendWords(String),
    /// Stop what the person asked.
    CancelQuery,
    /// Ask the database for a screen.
    Read(Reading),
    /// Put text into the clipboard.
    Copy(String),
    /// Show a text to read: its title and the text.
    ShowText(String, String),
    /// Write a file into the folder of the run; its name and contents. A name that is taken gets the next number.
    Write(String, Vec<u8>),
    /// Say something in the last line.
    Say(String),
    /// Say that something was refused.
    Complain(String),
    /// What follows begins a path of its own instead of going on with the one that led here.
    BeginPath,
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
    /// Ask once before calls that cannot be taken back.
    ConfirmCalls {
        /// Tools and arguments, in their order.
        calls: Vec<(ToolId, Value)>,
        /// What they mean.
        text: String,
    },
    /// Ask once before a step of the lesson, counted from 0, is tried again.
    TryStepAgain(usize),
    /// Open what came of the lesson.
    ShowDebrief,
    /// Explain something over what is open.
    Explain(Subject),
    /// Start a run for practice with the tour in it.
    StartTour,
    /// Lead participants through a study; nothing else can be reached.
    Receive(Box<Study>),
    /// Put texts of an earlier sitting back, or drop them.
    SettleOffer(bool),
    /// Stop the clock, with the reason where it was asked.
    StopClock(Option<String>),
    /// Save and leave, whatever is half typed.
    LeaveNow,
    /// Do what a key would do.
    Do(Action),
}
