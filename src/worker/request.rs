//! Requests of the console to the session thread.

use std::path::PathBuf;

use serde_json::Value;

use novamind_insight::DecisionEdit;
use novamind_record::consent::ConsentGiven;
use novamind_record::mode::Mode;
use novamind_report::class::ClassDisplayOptions;
use novamind_session::{Access, Forecasts, NewRun, SeekTarget};
use novamind_study::{DueQuestion, Study};
use novamind_tools::ToolId;

/// A request of the user.
#[derive(Debug, Clone)]
pub enum Request {
    /// List the runs of the folder.
    ListRuns,
    /// End a run of the folder.
    EndRun(String),
    /// Delete a run of the folder.
    DeleteRun(String),
    /// Read a collected class from its folder for display.
    ReadClass(PathBuf, ClassDisplayOptions),
    /// Start or resume the lesson of a handout.
    OpenHandout(PathBuf),
    /// Create a run in the folder.
    Create(Box<NewRun>),
    /// Open a run of the folder by its id, for play or read-only.
    Open(String, Access),
    /// Recover the undamaged prefix of a damaged run as a branch and open it.
    Recover(String),
    /// Replay a recorded run.
    Replay {
        /// The record.
        recorded: RecordSource,
        /// The initial position.
        goal: SeekTarget,
        /// Whether to follow new lines that another program writes.
        follow: bool,
    },
    /// Create a branch from the current position of the playback and continue in it.
    TakeOver(Mode),
    /// Create a branch that keeps the decisions of the run with some edits, and continue in it.
    AdoptBranch {
        /// The first week that the branch changes.
        week: u32,
        /// The edited decisions.
        edits: Vec<DecisionEdit>,
    },
    /// Call a tool.
    Call {
        /// Tool.
        tool: ToolId,
        /// Arguments.
        arguments: Value,
    },
    /// Undo the last setting.
    Undo,
    /// Redo the last undone setting.
    Redo,
    /// Run the week.
    Advance {
        /// The rationale.
        rationale: String,
        /// Forecasts of cash.
        forecasts: Forecasts,
    },
    /// Simulate a number of days of a debug run, up to a breakpoint.
    RunDays(u32),
    /// Save the notes.
    SetNotes(String),
    /// Build the run report for the final page.
    BuildRunReport,
    /// Render the files of the run report.
    RenderReportFiles,
    /// A request to the lesson of the run.
    Lesson(LessonRequest),
    /// A request in a study.
    Study(StudyRequest),
}

/// A request to a lesson. Steps and parts are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LessonRequest {
    /// Answer the question of the step.
    Guess(f64),
    /// Show the next hint.
    Hint,
    /// Retry a step from its start.
    RetryStep(usize),
    /// Start another part.
    StartPart(usize),
    /// Compute the debrief of a finished part.
    Debrief,
}

/// A request in a study.
#[derive(Debug, Clone)]
pub enum StudyRequest {
    /// Start receiving participants of this study.
    StartStudy(Box<Study>),
    /// The participant entered a label.
    IdentifyParticipant {
        /// The label.
        label: String,
        /// Number of labels rejected before.
        rejected_labels: u32,
    },
    /// The participant consents.
    Agree(ConsentGiven),
    /// The participant declines.
    Decline,
    /// The participant skips the practice.
    SkipPractice,
    /// The participant opens the next run.
    Play,
    /// The participant asks for the next step.
    ShowNextStep,
    /// A question was shown to the participant.
    RecordShownQuestion(Box<DueQuestion>),
    /// The participant submits the answers of a page.
    SubmitAnswers(Vec<GivenAnswer>),
    /// The participant withdraws, after confirmation.
    Withdraw,
    /// Check the experimenter's code.
    CheckCode(String),
}

/// The answer to a question, with how it was entered.
#[derive(Debug, Clone)]
pub struct GivenAnswer {
    /// The question.
    pub due: DueQuestion,
    /// The answer; null if it was skipped.
    pub value: Value,
    /// Milliseconds on the screen.
    pub shown_ms: u64,
    /// Number of changes before it was submitted.
    pub changes: u32,
}

/// A recorded run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RecordSource {
    /// A run of the folder, by its id.
    Run(String),
    /// Any run folder or trajectory file.
    File(PathBuf),
}

/// Label while a script runs.
pub const SCRIPT_STATUS: &str = "running the script";

impl Request {
    /// Returns whether it changes the run.
    pub fn changes_run(&self) -> bool {
        self.is_rejected_during_week() || self.simulates_days() || matches!(self, Request::SetNotes(_))
    }

    /// Returns whether it simulates days.
    pub fn simulates_days(&self) -> bool {
        matches!(self, Request::Advance { .. } | Request::RunDays(_))
    }

    /// Returns whether it is rejected while a week runs, because it was meant for the state before the week.
    pub fn is_rejected_during_week(&self) -> bool {
        let of_lesson =
            matches!(self, Request::Lesson(lesson_request) if *lesson_request != LessonRequest::Debrief);
        of_lesson || matches!(self, Request::Call { .. } | Request::Undo | Request::Redo)
    }

    /// Returns whether participants of a study must not send it, because it reaches beyond their own run.
    pub fn is_forbidden_for_participants(&self) -> bool {
        match self {
            Request::ListRuns
            | Request::EndRun(_)
            | Request::DeleteRun(_)
            | Request::ReadClass(..)
            | Request::OpenHandout(_)
            | Request::Create(_)
            | Request::Open(..)
            | Request::Recover(_)
            | Request::Replay { .. }
            | Request::TakeOver(_)
            | Request::AdoptBranch { .. }
            | Request::RunDays(_)
            | Request::Lesson(_)
            | Request::RenderReportFiles => true,
            Request::Call { .. }
            | Request::Undo
            | Request::Redo
            | Request::Advance { .. }
            | Request::SetNotes(_)
            | Request::BuildRunReport
            | Request::Study(_) => false,
        }
    }

    /// Returns the label shown until it is answered, or `None` if the user can continue meanwhile.
    pub fn busy_label(&self) -> Option<&'static str> {
        Some(match self {
            Request::Create(_) => "starting the run",
            Request::ReadClass(..) => "reading the class",
            Request::OpenHandout(_) => "opening the handout",
            Request::Open(..) => "opening the run",
            Request::Recover(_) => "opening the intact part of the run",
            Request::Replay { .. } => "opening the record",
            Request::TakeOver(_) => "starting a run from here",
            Request::AdoptBranch { .. } => "simulating the branch",
            Request::Lesson(LessonRequest::RetryStep(_)) => "returning to the start of the step",
            Request::Lesson(LessonRequest::StartPart(_)) => "starting the next part",
            Request::Advance { .. } => "running the week",
            Request::RunDays(_) => "simulating",
            Request::Call { tool, .. } if tool.executes_code() => SCRIPT_STATUS,
            Request::Study(StudyRequest::Play) => "opening the run",
            _ => return None,
        })
    }
}
