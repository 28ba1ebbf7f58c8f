//! Effects: work for the worker threads and changes of the display that an update requests.

use serde_json::Value;

use super::action::Action;
use super::context::{Figure, ScreenId};
use novamind_glossary::Subject;
use novamind_session::SeekTarget;
use novamind_session::identifiers::Group;
use novamind_study::Study;
use novamind_tools::ToolId;
use novamind_tui::widgets::ColumnLayout;
use novamind_worker::question::OutgoingQuestion;
use novamind_worker::request::{RecordSource, Request};
use novamind_worker::screen_queries::Reading;

impl Effect {
    /// Returns whether the effect would change the run.
    pub fn changes_run(&self) -> bool {
        match self {
            Effect::Request(request) => request.changes_run(),
            Effect::ConfirmCall { .. }
            | Effect::ConfirmCalls { .. }
            | Effect::ConfirmCommand(_)
            | Effect::SendCommand(_)
            | Effect::RunLines(_) => true,
            _ => false,
        }
    }

    /// Returns the effect that requests a tool call.
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
    ReplayWithXray(RecordSource, SeekTarget),
    /// Follow a run that another program plays, drawn for a projector.
    OpenProjector(RecordSource),
    /// Seek in the playback.
    Seek(SeekTarget),
    /// Send a question of a page to the worker. The page keeps the pending answer.
    Ask(OutgoingQuestion),
    /// Record that the draft with this recorded name was sent.
    SentText(&'static str),
    /// Show the causes of the change in a weekly figure.
    ShowCauses(Figure),
    /// Show the source rows of a figure.
    ShowRows(Figure),
    /// Close all dialogs.
    CloseDialogs,
    /// Show the participation curve of a group. The default is the group selected on the screen, or the first
    /// known group.
    ShowCurve(Option<Group>),
    /// Show the opponents page.
    ShowOpponents,
    /// Open another run of the folder by its id, after a confirmation if there are drafts.
    OpenRun(String),
    /// Ask for confirmation of a command that sets a parameter of the run.
    ConfirmCommand(String),
    /// Send a confirmed command that sets a parameter, from the X-ray screen.
    SendCommand(String),
    /// Stop the user's query.
    CancelQuery,
    /// Request the result of a screen query.
    Read(Reading),
    /// Copy text to the clipboard.
    Copy(String),
    /// Show a text with a title.
    ShowText(String, String),
    /// Write a file with a name and contents into the run folder. If the name exists, the next free number is used.
    Write(String, Vec<u8>),
    /// Show a status message.
    ShowStatus(String),
    /// Show an error message.
    ShowError(String),
    /// Arrange the columns of the focused table, and save the layout if the table has a name.
    ArrangeColumns(ColumnLayout),
    /// Clear the breadcrumbs before the following effects are executed.
    ClearBreadcrumbs,
    /// Show a screen.
    Show(ScreenId),
    /// Show the form of a tool.
    ShowTool(ToolId),
    /// Show the form of a tool and focus the first cell for a key, for example a group or a plan.
    ShowCell(ToolId, String),
    /// Show the form of a tool with arguments filled in.
    Prefill {
        /// The tool whose form is shown.
        tool: ToolId,
        /// Arguments to fill in, or `Null` for none.
        arguments: Value,
    },
    /// Show the thread with a number in the inbox.
    ShowThread(u32),
    /// Show a group on a screen.
    ShowGroup(ScreenId, Group),
    /// Copy a statement to the SQL editor.
    EditSql(String),
    /// Copy a statement to the SQL editor and run the statement.
    RunSql(String),
    /// Save a statement as a named query.
    SaveQuery {
        /// Name of the query's file.
        name: String,
        /// Title that is used if the statement contains no title.
        title: String,
        /// The SQL statement.
        sql: String,
    },
    /// Ask for confirmation of an irreversible call.
    ConfirmCall {
        /// The tool to call.
        tool: ToolId,
        /// Arguments of the call.
        arguments: Value,
        /// Description of the consequences, shown to the user.
        text: String,
    },
    /// Ask for confirmation of irreversible calls.
    ConfirmCalls {
        /// Tools and arguments of the calls, in execution order.
        calls: Vec<(ToolId, Value)>,
        /// Description of the consequences, shown to the user.
        text: String,
    },
    /// Run the own command with this index.
    RunOwnCommand(usize),
    /// Execute the confirmed lines of the own command with this index.
    RunLines(usize),
    /// Ask for confirmation before a step of the lesson, counted from 0, is retried.
    TryStepAgain(usize),
    /// Open the debrief.
    ShowDebrief,
    /// Open the explanation of a subject.
    Explain(Subject),
    /// Open the run of the tour, with the tour.
    StartTour,
    /// Show the pages of a study to participants.
    StartStudy(Box<Study>),
    /// Show the next step of the participant with a label in a hosted session of a study.
    StartHostedSession(Box<Study>, String),
    /// Restore the offered drafts (`true`) or discard the drafts (`false`).
    ResolveDraftOffer(bool),
    /// Stop the clock, with a reason if the study requires one.
    StopClock(Option<String>),
    /// Save and quit, discarding input in progress.
    LeaveNow,
    /// Execute an action.
    Execute(Action),
}
