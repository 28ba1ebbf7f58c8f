//! Effects: work for the worker threads and changes of the display that an update requests.

use serde_json::Value;

use super::action::Action;
use super::context::{Figure, ScreenId};
use novamind_glossary::Subject;
use novamind_session::SeekTarget;
use novamind_session::identifiers::Group;
use novamind_study::Study;
use novamind_tools::ToolId;
use novamind_worker::question::OutgoingQuestion;
use novamind_worker::readings::Reading;
use novamind_worker::request::{RecordSource, Request};

impl Effect {
    /// Returns whether it would change the run.
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

    /// Returns the effect of a tool call.
    pub fn call(tool: ToolId, arguments: Value) -> Effect {
        Effect::Request(Request::Call { tool, arguments })
    }
}

/// An effect that an update requests.
#[derive(Debug, Clone)]
pub enum Effect {
    /// Send a request to the session thread.
    Request(Request),
    /// Replay a recorded run from a position, with its hidden state.
    ReplayInside(RecordSource, SeekTarget),
    /// Follow a run that another program plays, drawn for a projector.
    Project(RecordSource),
    /// Seek in the playback.
    Go(SeekTarget),
    /// Send a question to the worker; the page that asks keeps the pending answer.
    Ask(OutgoingQuestion),
    /// A draft of the screen was sent; its place in the record.
    SentText(&'static str),
    /// Show the causes of the change of a weekly figure.
    AskWhy(Figure),
    /// Show the source rows of a figure.
    ShowRows(Figure),
    /// Close all dialogs.
    CloseDialogs,
    /// Show the participation curve of a group, by default of the first known one.
    ShowCurve(Option<Group>),
    /// Show the opponents page.
    ShowOpponents,
    /// Open another run of the folder by its id, after a confirmation if there are drafts.
    OpenRun(String),
    /// Ask for confirmation of a command that sets a parameter of the run.
    ConfirmWords(String),
    /// Send a confirmed command that sets a parameter, from the X-ray screen.
    SendWords(String),
    /// Stop the user's query.
    CancelQuery,
    /// Request a reading for a screen.
    Read(Reading),
    /// Copy text to the clipboard.
    Copy(String),
    /// Show a text with a title.
    ShowText(String, String),
    /// Write a file into the run folder: name and contents. If the name exists, the next free number is used.
    Write(String, Vec<u8>),
    /// Show a status message.
    Say(String),
    /// Show an error message.
    Complain(String),
    /// Clear the breadcrumbs before the effects that follow.
    BeginPath,
    /// Show a screen.
    Show(ScreenId),
    /// Show the form of a tool.
    ShowTool(ToolId),
    /// Show the form of a tool at the first cell for a group, a plan or similar.
    ShowCell(ToolId, String),
    /// Show the form of a tool with arguments filled in; `Null` fills in none.
    Prefill {
        /// Tool.
        tool: ToolId,
        /// Arguments.
        arguments: Value,
    },
    /// Show a thread in the inbox by number.
    ShowThread(u32),
    /// Show a group on a screen.
    ShowGroup(ScreenId, Group),
    /// Copy a statement to the SQL editor.
    EditSql(String),
    /// Copy a statement to the SQL editor and run it.
    RunSql(String),
    /// Save a statement as a named query.
    SaveQuery {
        /// Name of its file.
        name: String,
        /// Title, if the statement has none.
        title: String,
        /// Statement.
        sql: String,
    },
    /// Ask for confirmation of an irreversible call.
    ConfirmCall {
        /// Tool.
        tool: ToolId,
        /// Arguments.
        arguments: Value,
        /// Description of the consequences.
        text: String,
    },
    /// Ask for confirmation of irreversible calls.
    ConfirmCalls {
        /// Tools and arguments, in order.
        calls: Vec<(ToolId, Value)>,
        /// Description of the consequences.
        text: String,
    },
    /// Ask for confirmation before a step of the lesson, counted from 0, is retried.
    TryStepAgain(usize),
    /// Open the debrief.
    ShowDebrief,
    /// Explain a subject.
    Explain(Subject),
    /// Open the practice run with the tour.
    StartTour,
    /// Start receiving participants of a study.
    Receive(Box<Study>),
    /// Restore the offered drafts (`true`) or discard them.
    SettleOffer(bool),
    /// Stop the clock, with a reason if one was asked.
    StopClock(Option<String>),
    /// Save and quit, discarding input in progress.
    LeaveNow,
    /// Execute an action.
    Do(Action),
}
