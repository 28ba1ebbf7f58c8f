//! Messages to the console: input, and responses of the worker threads.

use std::sync::Arc;

use crossterm::event::Event;

use crate::company::Company;
use novamind_course::{CollectedClass, Debrief};
use novamind_record::folder::library::Library;
use novamind_record::folder::runs::RunSummary;
use novamind_record::trajectory::record::Limit;
use novamind_report::Story;
use novamind_report::class::Shown;
use novamind_session::{Change, PlaybackPosition, TimeLeft, UnsentTexts, Week};
use novamind_study::{DueQuestion, NextStep};
use novamind_tools::{Answer, Refusal, ToolId};

/// A message to the console.
pub enum Message {
    /// Input: a key, a click, pasted text or a window size.
    Input(Event),
    /// A response of a worker thread.
    News(News),
    /// An answer to a question of a page, or its progress.
    Arrived(Delivery),
    /// A signal to end, suspend or resume the program.
    Signal(i32),
    /// The requested time has passed.
    Time,
}

/// A position of the playback that was reached.
pub struct Arrival {
    /// The company at the position; `None` if it is unchanged.
    pub company: Option<Arc<Company>>,
    /// The position.
    pub place: PlaybackPosition,
    /// A problem to report to the user.
    pub problem: Option<String>,
}

/// An alternative for a run that does not open.
#[derive(Debug, Clone, PartialEq)]
pub enum Instead {
    /// It is open elsewhere: it can be followed, by id.
    Watch(String),
    /// It is damaged: its undamaged prefix can be recovered as a branch, by id.
    Rescue(String),
    /// The user must first consent to a text.
    Agree(Box<novamind_session::NewRun>),
}

/// Figures of a simulated day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DayTold {
    /// Cash at the end of the day, in dollars.
    pub cash: f64,
    /// Active individual subscriptions at the end of the day.
    pub subscribers: u32,
}

/// An answer or progress on its way to the page that asked.
pub struct Delivery {
    pub(super) put: Box<dyn FnOnce() + Send>,
    /// Whether it is the answer.
    pub is_answer: bool,
}

impl Delivery {
    /// Delivers it to the page, if the page still waits.
    pub fn deliver(self) {
        (self.put)();
    }
}

/// The result of simulating days of a debug run.
#[derive(Debug, Clone, PartialEq)]
pub struct DaysRan {
    /// Lines that describe why the simulation stopped.
    pub lines: Vec<String>,
    /// Whether the run has ended.
    pub is_over: bool,
}

/// A response of a worker thread.
pub enum News {
    /// The runs of the folder, after ending or deleting one with the outcome in words.
    Runs(Option<Result<String, String>>, Result<Vec<RunSummary>, String>),
    /// A class was read for display.
    Class(Box<Result<(CollectedClass, Shown), String>>),
    /// A handout was opened: the runs are now those of the student with this label.
    HandedOut(String),
    /// A run was opened.
    Opened(Arc<Company>),
    /// A playback was opened.
    Replays(Arc<Company>, Box<PlaybackPosition>),
    /// An inspection has changed the run.
    Changed(Arc<Company>),
    /// Seeking has ended.
    SeekResult(Box<Arrival>),
    /// The playback has advanced: it is playing, or the followed run has grown.
    WentOn(Box<Arrival>),
    /// The minutes left to time limits have changed.
    TimeLeft(Vec<TimeLeft>),
    /// A time limit is near or reached.
    Limit(Limit),
    /// The run was opened with a clock that a time limit had stopped.
    Held,
    /// Drafts from before the program stopped, of the opened run.
    Unsent(Box<UnsentTexts>),
    /// A run could not be opened or created; with an alternative.
    NotOpened(String, Option<Instead>),
    /// A tool was called.
    Called(ToolId, Result<Box<Answer>, Refusal>, Arc<Company>),
    /// A setting was undone or redone.
    Restored(&'static str, Result<Vec<Change>, Refusal>, Arc<Company>),
    /// A day was simulated; with its figures, unless it was simulated again.
    Day(u32, Option<DayTold>),
    /// A week has passed or was rejected.
    Advanced(Result<Box<Week>, Refusal>, Arc<Company>),
    /// The database cannot be written and is older than the company. Writing is retried.
    DatabaseBehind(String),
    /// The database is up to date again.
    DatabaseWhole,
    /// Days of a debug run were simulated.
    Ran(Result<DaysRan, Refusal>, Arc<Company>),
    /// A guess was recorded or a hint was shown in a lesson, or it was rejected.
    InLesson(Option<Refusal>, Arc<Company>),
    /// The debrief of a part of a lesson.
    Debriefed(Arc<Result<Debrief, Refusal>>),
    /// The notes were saved.
    MemoKept(Result<(), Refusal>, Arc<Company>),
    /// A query was saved: a text and the new library.
    QuerySaved(Result<(String, Library), String>),
    /// The run report.
    Told(Arc<Story>),
    /// The files of the run report: names and contents.
    Reported(Vec<(&'static str, String)>),
    /// Files were written: a text.
    Written(Result<String, String>),
    /// The run was closed, with the error if saving failed.
    Closed(Option<String>),
    /// A response in a study.
    Visit(VisitNews),
    /// A worker thread has panicked.
    Crashed(String),
    /// The record can no longer be written: the reason, and what to do.
    RecordLost(String),
}

/// A response in a study.
pub enum VisitNews {
    /// The study is ready for participants.
    Ready,
    /// The label was rejected, with the reason.
    LabelRefused(String),
    /// The next step of the participant.
    Next(NextStep),
    /// The participant declined.
    Declined,
    /// The due questions have changed. Sent before the response to the cause.
    Due(Vec<DueQuestion>),
    /// Answers were recorded; with the questions that are due now.
    Answered(Vec<DueQuestion>),
    /// Whether the experimenter's code was right; `None` if the study has no code.
    Code(Option<bool>),
    /// Reading or writing failed; the text says what is safe.
    Failed(String),
}
