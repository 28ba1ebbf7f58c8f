//! Messages to the console: input, and responses of the worker threads.

use std::sync::Arc;

use crossterm::event::Event;

use crate::company::DisplayedCompany;
use novamind_course::{CollectedClass, Debrief};
use novamind_record::folder::query_library::QueryLibrary;
use novamind_record::folder::runs::RunSummary;
use novamind_record::trajectory::record::Limit;
use novamind_report::RunReport;
use novamind_report::class::ClassDisplayOptions;
use novamind_session::{DraftTexts, PlaybackPosition, SettingChange, TimeLeft, WeekResult};
use novamind_study::{CodeOutcome, DueQuestion, NextStep};
use novamind_tools::{Answer, Rejection, ToolId};

/// A message that wakes the console.
pub enum Message {
    /// Input of the user: a key, a click, pasted text or a new window size.
    Input(Event),
    /// A response of a worker thread.
    Response(Response),
    /// An answer to a question of a page, or progress of the answer.
    Delivered(Delivery),
    /// A signal that ends, suspends or resumes the program.
    Signal(i32),
    /// The user's editor has ended: the edited text, or the reason why the text is unchanged.
    EditorClosed(Result<String, String>),
    /// The delay until the next scheduled redraw has passed.
    RedrawDue,
}

/// A new position of the playback, a problem, or both.
pub struct PlaybackUpdate {
    /// Company at the position; `None` if the company is unchanged.
    pub company: Option<Arc<DisplayedCompany>>,
    /// Position at which the playback is now.
    pub position: PlaybackPosition,
    /// Problem to report to the user, if any.
    pub problem: Option<String>,
}

/// What the user can do instead if a run cannot be opened.
#[derive(Debug, Clone, PartialEq)]
pub enum OpenFallback {
    /// The run with this id is open in another program and can be watched.
    Watch(String),
    /// The run with this id is damaged; its undamaged prefix can be recovered as a branch.
    Recover(String),
    /// The participant must first agree to the consent text.
    AskConsent(Box<novamind_session::NewRun>),
}

/// Figures of a simulated day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulatedDay {
    /// Cash at the end of the day, in dollars.
    pub cash: f64,
    /// Number of individuals with an active subscription at the end of the day.
    pub subscribers: u32,
}

/// An answer, or its progress, for the page that asked.
pub struct Delivery {
    pub(super) store: Box<dyn FnOnce() + Send>,
    /// Whether the delivery is the answer (true) or progress (false).
    pub is_answer: bool,
}

impl Delivery {
    /// Delivers the answer or progress to the page, if the page still waits.
    pub fn deliver(self) {
        (self.store)();
    }
}

/// The result of simulating days of a debug run.
#[derive(Debug, Clone, PartialEq)]
pub struct DebugRunResult {
    /// Lines that describe why the simulation stopped.
    pub lines: Vec<String>,
    /// Whether the run has ended, so that no more days can be simulated.
    pub has_ended: bool,
}

/// A response of a worker thread.
pub enum Response {
    /// The runs in the runs folder. If the request was to end or delete a run, also a message about the outcome.
    Runs(Option<Result<String, String>>, Result<Vec<RunSummary>, String>),
    /// A class was read for display, or reading failed.
    ClassRead(Box<Result<(CollectedClass, ClassDisplayOptions), String>>),
    /// A handout was opened. The runs folder is now the folder of the student with this label.
    HandoutOpened(String),
    /// A run was opened for play or read-only.
    Opened(Arc<DisplayedCompany>),
    /// A playback was opened.
    PlaybackOpened(Arc<DisplayedCompany>, Box<PlaybackPosition>),
    /// An inspection has changed the run.
    RunChanged(Arc<DisplayedCompany>),
    /// A seek of the user has ended.
    SeekResult(Box<PlaybackUpdate>),
    /// The playback has advanced to a new position, or the followed run has new lines.
    PlaybackAdvanced(Box<PlaybackUpdate>),
    /// The minutes left to time limits have changed.
    TimeLeft(Vec<TimeLeft>),
    /// A time limit is near or reached.
    Limit(Limit),
    /// A run was opened whose clock a time limit had stopped.
    ClockStopped,
    /// Drafts of the opened run that were saved before the program stopped.
    Drafts(Box<DraftTexts>),
    /// A run could not be opened or created. Contains the error message and what the user can do instead.
    NotOpened(String, Option<OpenFallback>),
    /// A tool call was executed or rejected.
    ToolCalled(ToolId, Result<Box<Answer>, Rejection>, Arc<DisplayedCompany>),
    /// A setting change was undone or redone, or the request to do so was rejected.
    SettingRestored(&'static str, Result<Vec<SettingChange>, Rejection>, Arc<DisplayedCompany>),
    /// A day was simulated. Contains its figures if the day was simulated for the first time.
    DaySimulated(u32, Option<SimulatedDay>),
    /// A week was simulated or rejected.
    WeekAdvanced(Result<Box<WeekResult>, Rejection>, Arc<DisplayedCompany>),
    /// The database cannot be written, so the newest rows are missing. Writing is retried.
    DatabaseBehind(String),
    /// The database is up to date again.
    DatabaseCurrent,
    /// Days of a debug run were simulated.
    DebugDaysSimulated(Result<DebugRunResult, Rejection>, Arc<DisplayedCompany>),
    /// In a lesson, a guess was recorded or a hint was shown, or this was rejected.
    LessonUpdated(Option<Rejection>, Arc<DisplayedCompany>),
    /// The debrief of a lesson part was computed.
    DebriefReady(Arc<Result<Debrief, Rejection>>),
    /// The notes were saved, or saving failed.
    NotesSaved(Result<(), Rejection>, Arc<DisplayedCompany>),
    /// A query was saved, or saving failed. Contains a message and the new library.
    QuerySaved(Result<(String, QueryLibrary), String>),
    /// The run report was built.
    RunReportReady(Arc<RunReport>),
    /// The files of the run report were rendered. Contains their names and contents.
    ReportFilesReady(Vec<(&'static str, String)>),
    /// Files were written, or writing failed. Contains a message.
    FilesWritten(Result<String, String>),
    /// An external program of the user ended. Contains a title and the output of the program, or the error if the
    /// program did not end normally.
    ProgramEnded(Result<(String, String), String>),
    /// The run was closed. Contains the error if saving failed.
    Closed(Option<String>),
    /// A response to a request in a study.
    Study(StudyResponse),
    /// A worker thread has panicked. Contains the message of the panic.
    Crashed(String),
    /// The record can no longer be written. Contains the reason and the next step.
    RecordLost(String),
}

/// A response to a request in a study.
pub enum StudyResponse {
    /// The study is ready for participants.
    Ready,
    /// The participant's label was rejected, with the reason.
    LabelRejected(String),
    /// The participant continues with this step.
    Next(NextStep),
    /// The participant declined the consent text.
    ConsentDeclined,
    /// The due questions have changed. Sent before the response to the request that caused the change.
    QuestionsDue(Vec<DueQuestion>),
    /// Answers were recorded. Contains the questions that are due now.
    AnswersRecorded(Vec<DueQuestion>),
    /// The entered experimenter code was checked.
    CodeChecked(CodeOutcome),
    /// The experimenter code that was entered to start the clock was checked.
    LimitCodeChecked(CodeOutcome),
    /// Reading or writing failed. The message names the data that is safe.
    Failed(String),
}
