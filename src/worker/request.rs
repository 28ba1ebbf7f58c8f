//! Requests of the console to the session thread.

use std::path::PathBuf;

use serde_json::Value;

use novamind_insight::DecisionEdit;
use novamind_record::consent::ConsentDetails;
use novamind_record::mode::Mode;
use novamind_report::class::ClassDisplayOptions;
use novamind_session::{Access, Forecasts, NewRun, SeekTarget};
use novamind_study::{DueQuestion, Study};
use novamind_tools::ToolId;

/// A request of the user to the session thread.
#[derive(Debug, Clone)]
pub enum Request {
    /// List the runs in the runs folder.
    ListRuns,
    /// End the run with this id.
    EndRun(String),
    /// Delete the run with this id.
    DeleteRun(String),
    /// Read a collected class from its folder for display.
    ReadClass(PathBuf, ClassDisplayOptions),
    /// Start or resume the lesson of a handout.
    OpenHandout(PathBuf),
    /// Create a run in the runs folder and open it.
    Create(Box<NewRun>),
    /// Open the run with this id, for play or read-only.
    Open(String, Access),
    /// Recover the undamaged prefix of a damaged run as a branch and open it.
    Recover(String),
    /// Open a playback of a recorded run.
    Replay {
        /// Run or file to play back.
        recorded: RecordSource,
        /// Initial position of the playback.
        goal: SeekTarget,
        /// Whether to follow new lines that another program writes.
        follow: bool,
    },
    /// Create a branch from the current position of the playback and play the branch.
    TakeOver(Mode),
    /// Create a branch with the decisions of the run as changed by `edits`, and play the branch.
    AdoptBranch {
        /// First week in which the branch differs from the run.
        week: u32,
        /// Changes of the recorded decisions.
        edits: Vec<DecisionEdit>,
    },
    /// Execute a tool call.
    Call {
        /// Tool that is called.
        tool: ToolId,
        /// Arguments of the call, not yet validated.
        arguments: Value,
    },
    /// Undo the last setting change.
    Undo,
    /// Redo the last undone setting change.
    Redo,
    /// Submit the week and simulate it.
    Advance {
        /// Rationale that the user entered for the week.
        rationale: String,
        /// Forecasts of cash for all horizons, in dollars.
        forecasts: Forecasts,
    },
    /// Simulate at most this number of days of a debug run, up to the next breakpoint.
    RunDays(u32),
    /// Save this text as the player's notes.
    SetNotes(String),
    /// Build the run report for the final page.
    BuildRunReport,
    /// Render the files of the run report.
    RenderReportFiles,
    /// Handle a request in the lesson of the run.
    Lesson(LessonRequest),
    /// Handle a request in a study.
    Study(StudyRequest),
}

/// A request of a student in a lesson. Steps and parts are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LessonRequest {
    /// Answer the question of the step with this number.
    Guess(f64),
    /// Show the next hint.
    Hint,
    /// Retry the step with this index from its start.
    RetryStep(usize),
    /// Start the part with this index.
    StartPart(usize),
    /// Compute the debrief of a finished part.
    Debrief,
}

/// A request of a participant or an experimenter in a study.
#[derive(Debug, Clone)]
pub enum StudyRequest {
    /// Start this study, so that participants can enter their labels.
    StartStudy(Box<Study>),
    /// The participant has entered a label.
    IdentifyParticipant {
        /// Label that the participant entered.
        label: String,
        /// Number of labels that were rejected before.
        rejected_labels: u32,
    },
    /// The participant agrees to the consent text.
    Agree(ConsentDetails),
    /// The participant declines the consent text.
    Decline,
    /// The participant skips the practice run.
    SkipPractice,
    /// The participant opens the next run.
    Play,
    /// The participant asks for the next step.
    ShowNextStep,
    /// A question was shown to the participant.
    RecordShownQuestion(Box<DueQuestion>),
    /// The participant submits the answers on a page.
    SubmitAnswers(Vec<GivenAnswer>),
    /// The participant has confirmed the withdrawal from the study.
    Withdraw,
    /// Check the experimenter code that was entered, and give access to the start menu.
    CheckCode(String),
    /// Check the experimenter code that was entered to start the clock after a time limit has stopped it.
    LiftLimit(String),
}

/// The participant's answer to a question, with details of how it was entered.
#[derive(Debug, Clone)]
pub struct GivenAnswer {
    /// Question that the participant answered.
    pub due: DueQuestion,
    /// Value of the answer; null if the question was skipped.
    pub value: Value,
    /// Milliseconds for which the question was on the screen.
    pub shown_ms: u64,
    /// Number of times that the participant changed the answer before submitting it.
    pub changes: u32,
}

/// Where a recorded run is stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RecordSource {
    /// The run with this id in the runs folder.
    Run(String),
    /// Any run folder or trajectory file.
    File(PathBuf),
}

/// Status text that is shown while a script runs.
pub const SCRIPT_STATUS: &str = "running the script";

impl Request {
    /// Returns whether the request changes the run.
    pub fn changes_run(&self) -> bool {
        self.is_rejected_during_week() || self.simulates_days() || matches!(self, Request::SetNotes(_))
    }

    /// Returns whether the request simulates days.
    pub fn simulates_days(&self) -> bool {
        matches!(self, Request::Advance { .. } | Request::RunDays(_))
    }

    /// Returns whether the request is rejected while a week is simulated, because it was intended for the state before
    /// the week.
    pub fn is_rejected_during_week(&self) -> bool {
        let of_lesson =
            matches!(self, Request::Lesson(lesson_request) if *lesson_request != LessonRequest::Debrief);
        of_lesson || matches!(self, Request::Call { .. } | Request::Undo | Request::Redo)
    }

    /// Returns whether participants of a study may not send the request, because it affects more than their current
    /// run.
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

    /// Returns the status text that is shown until the response, or `None` if the user can continue before the
    /// response.
    pub fn busy_label(&self) -> Option<&'static str> {
        Some(match self {
            Request::Create(_) => "starting the run",
            Request::ReadClass(..) => "reading the class",
            Request::OpenHandout(_) => "opening the handout",
            Request::Open(..) => "opening the run",
            Request::Recover(_) => "recovering the run",
            Request::Replay { .. } => "opening the record",
            Request::TakeOver(_) => "creating the branch",
            Request::AdoptBranch { .. } => "simulating the branch",
            Request::Lesson(LessonRequest::RetryStep(_)) => "returning to the start of the step",
            Request::Lesson(LessonRequest::StartPart(_)) => "starting the next part",
            Request::Advance { .. } => "simulating the week",
            Request::RunDays(_) => "simulating",
            Request::Call { tool, .. } if tool.executes_code() => SCRIPT_STATUS,
            Request::Study(StudyRequest::Play) => "opening the run",
            _ => return None,
        })
    }
}
