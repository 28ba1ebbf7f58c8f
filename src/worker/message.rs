//! What arrives at the screen: input, and news of the threads behind it.

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

/// Something that arrives.
pub enum Message {
    /// A key, a click, pasted text, another window size.
    Input(Event),
    /// From the threads behind the screen.
    News(News),
    /// The answer to a question of a page, or how far the work for it has come.
    Arrived(Delivery),
    /// A signal asks the program to end, to stop for a while, or to go on.
    Signal(i32),
    /// Time has passed, as the application has asked.
    Time,
}

/// A moment of a replay that was reached.
pub struct Arrival {
    /// The company of that moment; none where nothing has changed.
    pub company: Option<Arc<Company>>,
    /// Where it is.
    pub place: PlaybackPosition,
    /// What the person should know.
    pub problem: Option<String>,
}

/// What can be done with a run that does not open.
#[derive(Debug, Clone, PartialEq)]
pub enum Instead {
    /// Somebody else plays it: it can be watched.
    Watch(String),
    /// It is damaged: its good beginning can be opened as a branch.
    Rescue(String),
    /// A participant has to agree to a text before this run begins.
    Agree(Box<novamind_session::NewRun>),
}

/// What a simulated day came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DayTold {
    /// Cash at its end, dollars.
    pub cash: f64,
    /// Active subscriptions of individuals at its end.
    pub subscribers: u32,
}

/// An answer, or how far the work for one has come, on its way to the page that asked.
pub struct Delivery {
    pub(super) put: Box<dyn FnOnce() + Send>,
    /// It is the answer: nothing follows it.
    pub is_answer: bool,
}

impl Delivery {
    /// Gives it to the page, if that still waits for it.
    pub fn deliver(self) {
        (self.put)();
    }
}

/// Days of a debug run that were simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct DaysRan {
    /// Why they stopped, in words.
    pub lines: Vec<String>,
    /// The run is over.
    pub is_over: bool,
}

/// What a thread behind the screen reports.
pub enum News {
    /// The runs of the folder; if a run was given up or deleted, after a sentence, or what went wrong.
    Runs(Option<Result<String, String>>, Result<Vec<RunSummary>, String>),
    /// A class was read, to be shown in some way.
    Class(Box<Result<(CollectedClass, Shown), String>>),
    /// The runs are those of a student from now on, because a hand-out of theirs was opened.
    HandedOut(String),
    /// A run is open.
    Opened(Arc<Company>),
    /// A run is played again.
    Replays(Arc<Company>, Box<PlaybackPosition>),
    /// The run was changed by a look at its hidden state.
    Changed(Arc<Company>),
    /// The replay has gone where it was sent, or tried to.
    SeekResult(Box<Arrival>),
    /// The replay has gone on by itself: it plays, or somebody else has played.
    WentOn(Box<Arrival>),
    /// Minutes that are left to a time limit have changed.
    TimeLeft(Vec<TimeLeft>),
    /// A time limit is near or reached.
    Limit(Limit),
    /// A time limit had stopped the clock of the run that was opened, and nobody has started it.
    Held,
    /// Texts that were typed when the program was stopped in the run that was opened.
    Unsent(Box<UnsentTexts>),
    /// A run could not be opened or created; with what can be done instead.
    NotOpened(String, Option<Instead>),
    /// A tool was called.
    Called(ToolId, Result<Box<Answer>, Refusal>, Arc<Company>),
    /// A setting was undone or redone.
    Restored(&'static str, Result<Vec<Change>, Refusal>, Arc<Company>),
    /// A day was simulated, or simulated again; with what it came to, where that is news.
    Day(u32, Option<DayTold>),
    /// A week has passed, or was refused.
    Advanced(Result<Box<Week>, Refusal>, Arc<Company>),
    /// The database cannot be written: what it tells is older than the company. It is tried again.
    DatabaseBehind(String),
    /// The database holds everything again.
    DatabaseWhole,
    /// Days of a debug run were simulated up to a breakpoint.
    Ran(Result<DaysRan, Refusal>, Arc<Company>),
    /// The question of a lesson was answered, or a hint was taken: what was refused, if something was.
    InLesson(Option<Refusal>, Arc<Company>),
    /// What came of a part of a lesson.
    Debriefed(Arc<Result<Debrief, Refusal>>),
    /// The notes were kept.
    MemoKept(Result<(), Refusal>, Arc<Company>),
    /// A query was saved: a sentence and all queries, or what went wrong.
    QuerySaved(Result<(String, Library), String>),
    /// The story of the run.
    Told(Arc<Story>),
    /// The report of the run: names of files and what they hold.
    Reported(Vec<(&'static str, String)>),
    /// Files were written: a sentence, or what went wrong.
    Written(Result<String, String>),
    /// The run was saved and closed; what went wrong, if something did.
    Closed(Option<String>),
    /// Of a participant's way through a study.
    Visit(VisitNews),
    /// A thread behind the screen has failed for a reason that should not exist.
    Crashed(String),
    /// The run's file is no longer the one it was: why, and what to do.
    RecordLost(String),
}

/// What is reported of a participant's way through a study.
pub enum VisitNews {
    /// Participants can come.
    Ready,
    /// The label was refused, and why.
    LabelRefused(String),
    /// What comes next for the participant.
    Next(NextStep),
    /// The participant does not agree.
    Declined,
    /// What is due has changed; it comes before the news of what has changed it.
    Due(Vec<DueQuestion>),
    /// Answers were recorded; what is due now.
    Answered(Vec<DueQuestion>),
    /// Whether the code was the experimenter's; none: the study has no code.
    Code(Option<bool>),
    /// Something cannot be read or written; what is safe.
    Failed(String),
}
