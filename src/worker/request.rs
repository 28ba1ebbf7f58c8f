//! What the screen asks of the run and of the folder of runs: work for the thread that owns the session.

use std::path::PathBuf;

use serde_json::Value;

use novamind_insight::DecisionEdit;
use novamind_record::consent::ConsentGiven;
use novamind_record::mode::Mode;
use novamind_report::class::Shown;
use novamind_session::{Access, Forecasts, Goal, NewRun};
use novamind_study::{DueQuestion, Study};
use novamind_tools::ToolId;

/// Work that a person asked for.
#[derive(Debug, Clone)]
pub enum Request {
    /// List the runs of the folder.
    ListRuns,
    /// Give up a run of the folder.
    EndRun(String),
    /// Delete a run of the folder.
    DeleteRun(String),
    /// Read a class that was collected, from its folder, to be shown in some way.
    ReadClass(PathBuf, Shown),
    /// Begin, or go on with, what a hand-out of a class holds.
    OpenHandout(PathBuf),
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
    /// Go on in a branch that keeps the decisions of the run from a week on, some of them edited.
    AdoptBranch {
        /// The week.
        week: u32,
        /// What is decided otherwise.
        edits: Vec<DecisionEdit>,
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
    /// Simulate days of a debug run, up to a breakpoint.
    RunDays(u32),
    /// Keep the notes.
    SetMemo(String),
    /// Tell the story of the run for the final page.
    TellStory,
    /// Put the report of the run into words.
    WriteReport,
    /// Do something in the lesson of the run.
    Lesson(LessonRequest),
    /// Lead a participant through a study.
    Visit(VisitRequest),
}

/// What a person asks of a lesson. Steps and parts are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LessonRequest {
    /// The answer to the question of the step.
    Guess(f64),
    /// The next hint.
    Hint,
    /// A step again from its beginning.
    TryAgain(usize),
    /// Another part.
    BeginPart(usize),
    /// What came of a part that is over.
    Debrief,
}

/// What a participant's way through a study asks for.
#[derive(Debug, Clone)]
pub enum VisitRequest {
    /// Participants of this study come.
    Receive(Box<Study>),
    /// A participant has given a label.
    Begin {
        /// The label.
        label: String,
        /// How many labels were refused before.
        refused: u32,
    },
    /// They agree to the text of the study.
    Agree(ConsentGiven),
    /// They do not.
    Decline,
    /// They pass over the practice.
    PassPractice,
    /// They play what comes next.
    Play,
    /// They ask what comes next.
    GoOn,
    /// A question is shown to them.
    Ask(Box<DueQuestion>),
    /// They send the answers of a page.
    Answer(Vec<GivenAnswer>),
    /// They withdraw, and have confirmed it.
    Withdraw,
    /// Somebody gives the experimenter's code.
    TryCode(String),
}

/// The answer to a question, and how it came to be.
#[derive(Debug, Clone)]
pub struct GivenAnswer {
    /// The question.
    pub due: DueQuestion,
    /// The answer; null where it was passed over.
    pub value: Value,
    /// Milliseconds on the screen.
    pub for_ms: u64,
    /// How often it was changed before it was sent.
    pub changes: u32,
}

/// A run that was recorded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Recorded {
    /// One of the folder of runs, by its id.
    Run(String),
    /// A folder of a run or a trajectory file anywhere.
    File(PathBuf),
}

/// What the screen is busy with while a script runs.
pub const SCRIPT_RUNS: &str = "the script runs";

impl Request {
    /// Whether it would change the run.
    pub fn changes_run(&self) -> bool {
        self.waits_for_week() || self.lets_time_pass() || matches!(self, Request::SetMemo(_))
    }

    /// Whether days are simulated by it.
    pub fn lets_time_pass(&self) -> bool {
        matches!(self, Request::Advance { .. } | Request::RunDays(_))
    }

    /// Whether it is refused while a week runs: it was meant for the company as it was before.
    pub fn waits_for_week(&self) -> bool {
        let of_lesson = matches!(self, Request::Lesson(asked) if *asked != LessonRequest::Debrief);
        of_lesson || matches!(self, Request::Call { .. } | Request::Undo | Request::Redo)
    }

    /// Whether participants of a study cannot ask for it: it reaches beyond their own run.
    pub fn is_kept_from_participants(&self) -> bool {
        match self {
            Request::ListRuns
            | Request::EndRun(_)
            | Request::DeleteRun(_)
            | Request::ReadClass(..)
            | Request::OpenHandout(_)
            | Request::Create(_)
            | Request::Open(..)
            | Request::Rescue(_)
            | Request::Replay { .. }
            | Request::TakeOver(_)
            | Request::AdoptBranch { .. }
            | Request::RunDays(_)
            | Request::Lesson(_)
            | Request::WriteReport => true,
            Request::Call { .. }
            | Request::Undo
            | Request::Redo
            | Request::Advance { .. }
            | Request::SetMemo(_)
            | Request::TellStory
            | Request::Visit(_) => false,
        }
    }

    /// What the screen is busy with until it is answered; none where the person goes on meanwhile.
    pub fn busy_with(&self) -> Option<&'static str> {
        Some(match self {
            Request::Create(_) => "starting the run",
            Request::ReadClass(..) => "reading the class",
            Request::OpenHandout(_) => "opening the hand-out",
            Request::Open(..) => "opening the run",
            Request::Rescue(_) => "opening the intact part of the run",
            Request::Replay { .. } => "opening the record",
            Request::TakeOver(_) => "starting a run from here",
            Request::AdoptBranch { .. } => "playing the branch",
            Request::Lesson(LessonRequest::TryAgain(_)) => "going back to the beginning of the step",
            Request::Lesson(LessonRequest::BeginPart(_)) => "starting the next part",
            Request::Advance { .. } => "the week runs",
            Request::RunDays(_) => "simulating",
            Request::Call { tool, .. } if tool.runs_code() => SCRIPT_RUNS,
            Request::Visit(VisitRequest::Play) => "opening the run",
            _ => return None,
        })
    }
}
