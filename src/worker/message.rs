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
use novamind_study::{DueQuestion, NextStep};
use novamind_tools::{Answer, Rejection, ToolId};

/// A message to the console.
pub enum Message {
    /// Input: a key, a click, pasted text or a window size.
    Input(Event),
    /// A response of a worker thread.
    Response(Response),
    /// An answer to a question of a page, or its progress.
    Arrived(Delivery),
    /// A signal to end, suspend or resume the program.
    Signal(i32),
    /// The requested time has passed.
    TimePassed,
}

/// A position of the playback that was reached.
pub struct PlaybackUpdate {
    /// The company at the position; `None` if it is unchanged.
    pub company: Option<Arc<DisplayedCompany>>,
    /// The position.
    pub position: PlaybackPosition,
    /// A problem to report to the user.
    pub problem: Option<String>,
}

/// An alternative for a run that does not open.
#[derive(Debug, Clone, PartialEq)]
pub enum OpenFallback {
    /// It is open elsewhere: it can be followed, by id.
    Watch(String),
    /// It is damaged: its undamaged prefix can be recovered as a branch, by id.
    Recover(String),
    /// The user must first consent to a text.
    AskConsent(Box<novamind_session::NewRun>),
}

/// Figures of a simulated day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulatedDay {
    /// Cash at the end of the day, in dollars.
    pub cash: f64,
    /// Active individual subscriptions at the end of the day.
    pub subscribers: u32,
}

/// An answer or progress on its way to the page that asked.
pub struct Delivery {
    pub(super) store: Box<dyn FnOnce() + Send>,
    /// Whether it is the answer.
    pub is_answer: bool,
}

impl Delivery {
    /// Delivers it to the page, if the page still waits.
    pub fn deliver(self) {
        (self.store)();
    }
}

/// The result of simulating days of a debug run.
#[derive(Debug, Clone, PartialEq)]
pub struct DebugRunResult {
    /// Lines that describe why the simulation stopped.
    pub lines: Vec<String>,
    /// Whether the run has ended.
    pub has_ended: bool,
}

/// A response of a worker thread.
pub enum Response {
    /// The runs of the folder, after ending or deleting one with the outcome in words.
    Runs(Option<Result<String, String>>, Result<Vec<RunSummary>, String>),
    /// A class was read for display.
    ClassRead(Box<Result<(CollectedClass, ClassDisplayOptions), String>>),
    /// A handout was opened: the runs are now those of the student with this label.
    HandoutOpened(String),
    /// A run was opened.
    Opened(Arc<DisplayedCompany>),
    /// A playback was opened.
    PlaybackOpened(Arc<DisplayedCompany>, Box<PlaybackPosition>),
    /// An inspection has changed the run.
    RunChanged(Arc<DisplayedCompany>),
    /// Seeking has ended.
    SeekResult(Box<PlaybackUpdate>),
    /// The playback has advanced: it is playing, or the followed run has grown.
    PlaybackAdvanced(Box<PlaybackUpdate>),
    /// The minutes left to time limits have changed.
    TimeLeft(Vec<TimeLeft>),
    /// A time limit is near or reached.
    Limit(Limit),
    /// The run was opened with a clock that a time limit had stopped.
    ClockStopped,
    /// Drafts from before the program stopped, of the opened run.
    Drafts(Box<DraftTexts>),
    /// A run could not be opened or created; with an alternative.
    NotOpened(String, Option<OpenFallback>),
    /// A tool was called.
    ToolCalled(ToolId, Result<Box<Answer>, Rejection>, Arc<DisplayedCompany>),
    /// A setting was undone or redone.
    SettingRestored(&'static str, Result<Vec<SettingChange>, Rejection>, Arc<DisplayedCompany>),
    /// A day was simulated; with its figures, unless it was simulated again.
    DaySimulated(u32, Option<SimulatedDay>),
    /// A week has passed or was rejected.
    WeekAdvanced(Result<Box<WeekResult>, Rejection>, Arc<DisplayedCompany>),
    /// The database cannot be written and is older than the company. Writing is retried.
    DatabaseBehind(String),
    /// The database is up to date again.
    DatabaseCurrent,
    /// Days of a debug run were simulated.
    DebugDaysSimulated(Result<DebugRunResult, Rejection>, Arc<DisplayedCompany>),
    /// A guess was recorded or a hint was shown in a lesson, or it was rejected.
    LessonUpdated(Option<Rejection>, Arc<DisplayedCompany>),
    /// The debrief of a part of a lesson.
    DebriefReady(Arc<Result<Debrief, Rejection>>),
    /// The notes were saved.
    NotesSaved(Result<(), Rejection>, Arc<DisplayedCompany>),
    /// A query was saved: a text and the new library.
    QuerySaved(Result<(String, QueryLibrary), String>),
    /// The run report.
    RunReportReady(Arc<RunReport>),
    /// The files of the run report: names and contents.
    ReportFilesReady(Vec<(&'static str, String)>),
    /// Files were written: a text.
    FilesWritten(Result<String, String>),
    /// The run was closed, with the error if saving failed.
    Closed(Option<String>),
    /// A response in a study.
    Study(StudyResponse),
    /// A worker thread has panicked.
    Crashed(String),
    /// The record can no longer be written: the reason, and what to do.
    RecordLost(String),
}

/// A response in a study.
pub enum StudyResponse {
    /// The study is ready for participants.
    Ready,
    /// The label was rejected, with the reason.
    LabelRejected(String),
    /// The next step of the participant.
    Next(NextStep),
    /// The participant declined.
    ConsentDeclined,
    /// The due questions have changed. Sent before the response to the cause.
    QuestionsDue(Vec<DueQuestion>),
    /// Answers were recorded; with the questions that are due now.
    AnswersRecorded(Vec<DueQuestion>),
    /// Whether the experimenter's code was right; `None` if the study has no code.
    CodeChecked(Option<bool>),
    /// Reading or writing failed; the text says what is safe.
    Failed(String),
}
