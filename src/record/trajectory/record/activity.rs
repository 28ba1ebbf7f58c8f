//! Activity of a user that does not change the run: viewed screens, opened objects, typed texts, presence. A replay
//! skips lines of activity.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::lesson::RecordedLessonEvent;
use super::presence::{Clock, Limit, Presence};
use super::questions::{QuestionAnswer, QuestionShown};

/// An activity of the user or the program that does not change the run.
#[derive(Debug, Clone, PartialEq)]
pub enum Activity {
    /// The program attached to or detached from the run, or the user left or returned.
    Session(Box<Presence>),
    /// The clock was stopped or restarted.
    Clock(Clock),
    /// The participant was warned about a time limit, or a time limit was reached.
    Limit(Limit),
    /// The user viewed a screen.
    View(ScreenView),
    /// The user opened an object, for example a group, a thread, a tool or a post.
    Select(ObjectSelection),
    /// The user opened a dialog and closed it.
    Dialog(DialogUse),
    /// The user requested the explanation of a term.
    Help(HelpRequest),
    /// The user edited a text and then sent or abandoned it.
    Draft(TextEdit),
    /// A study question was shown to the participant.
    Question(QuestionShown),
    /// The participant answered or skipped a study question.
    Answer(QuestionAnswer),
    /// An event occurred in the lesson of the run.
    Lesson(RecordedLessonEvent),
    /// A command outside the session read the run.
    ExternalRead(ExternalRead),
    /// The user inspected hidden state.
    Inspection(Inspection),
}

/// The period for which a screen was viewed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ScreenView {
    /// Name of the viewed screen.
    pub screen: String,
    /// Name of the previous screen; empty for the first screen.
    pub from: String,
    /// Milliseconds for which the screen was viewed.
    pub for_ms: u64,
}

/// An object that was opened on a screen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ObjectSelection {
    /// Name of the screen on which the object was opened.
    pub screen: String,
    /// Kind of the object: `group`, `thread`, `tool`, `post`, `study`, `table`, `figure`, `command`.
    pub what: String,
    /// Name that tools and tables use for the object.
    pub which: String,
}

/// The use of a dialog, recorded when the dialog is closed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DialogUse {
    /// Name of the dialog.
    pub what: String,
    /// Whether the user confirmed or cancelled the dialog.
    pub outcome: DialogOutcome,
    /// Milliseconds for which the dialog was open.
    pub for_ms: u64,
    /// Steps of the dialog in the order in which the user entered them, with their durations.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<DialogStep>,
}

/// Outcome of a dialog.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DialogOutcome {
    /// The user confirmed the dialog.
    Confirmed,
    /// The user closed the dialog without confirming.
    Cancelled,
}

/// A step of a dialog.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DialogStep {
    /// Name of the step.
    pub step: String,
    /// Milliseconds for which the step was shown.
    pub for_ms: u64,
}

/// A request for the explanation of a term.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct HelpRequest {
    /// Explained term, tool, table or column.
    pub term: String,
    /// Where the user requested the explanation: a screen, a dialog or `plain`.
    pub place: String,
}

/// Statistics about a text that the user edited.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextEdit {
    /// Edited field: `rationale`, `forecasts`, `notes`, `sql`, `post`, or `form` and the tool.
    pub place: String,
    /// Whether the text was sent, abandoned or restored.
    pub outcome: TextEditOutcome,
    /// Length of the text when it was sent or abandoned, in characters.
    pub length: u64,
    /// Number of typed characters.
    pub typed: u64,
    /// Number of deleted characters.
    pub deleted: u64,
    /// Number of pasted characters.
    pub pasted: u64,
    /// Number of pauses of more than two seconds between key presses.
    pub pauses: u32,
    /// Milliseconds from the first key press to the last.
    pub for_ms: u64,
    /// The abandoned text, if the rules keep it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// Outcome of an edited text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TextEditOutcome {
    /// The text was sent or saved.
    Sent,
    /// The text was abandoned.
    Left,
    /// The text was restored after a restart of the program.
    Restored,
}

/// A command outside the session that read the run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ExternalRead {
    /// Command: `query`, `report`, `replay`, `pictures`, `compare`.
    pub command: String,
    /// SQL statement or output format of the command.
    pub detail: String,
}

/// An inspection of hidden state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inspection {
    /// Kind of the inspection, for example `leads`, `customer` or `sql`.
    pub what: String,
    /// Inspected group, customer or part, or the SQL statement; empty if inspections of this kind have no subject.
    pub which: String,
    /// Day whose hidden state was shown.
    pub shown_day: u32,
}

impl Activity {
    /// Kinds of activity that a study can exclude from the record. Inspections and lesson events are always recorded.
    pub const OPTIONAL_KINDS: [&str; 11] = [
        "session", "clock", "limit", "view", "select", "dialog", "help", "draft", "question", "answer",
        "look",
    ];

    /// Returns the `kind` field of the activity's line.
    pub fn kind(&self) -> &'static str {
        match self {
            Activity::Session(_) => "session",
            Activity::Clock(_) => "clock",
            Activity::Limit(_) => "limit",
            Activity::View(_) => "view",
            Activity::Select(_) => "select",
            Activity::Dialog(_) => "dialog",
            Activity::Help(_) => "help",
            Activity::Draft(_) => "draft",
            Activity::Question(_) => "question",
            Activity::Answer(_) => "answer",
            Activity::Lesson(_) => "lesson",
            Activity::ExternalRead(_) => "look",
            Activity::Inspection(_) => "xray",
        }
    }

    /// Returns whether the activity is evidence that no other line contains. Lines with evidence are synced at once.
    pub fn is_evidence(&self) -> bool {
        !matches!(
            self,
            Activity::View(_)
                | Activity::Select(_)
                | Activity::Dialog(_)
                | Activity::Help(_)
                | Activity::Draft(_)
        )
    }

    /// Parses a line of the given kind. Returns `None` if the kind is not an activity.
    pub(super) fn parse(kind: &str, line: &[u8]) -> Option<serde_json::Result<Activity>> {
        fn parse_as<'a, T: Deserialize<'a>>(
            line: &'a [u8],
            kind: fn(T) -> Activity,
        ) -> serde_json::Result<Activity> {
            serde_json::from_slice(line).map(kind)
        }
        Some(match kind {
            "session" => parse_as(line, |presence| Activity::Session(Box::new(presence))),
            "clock" => parse_as(line, Activity::Clock),
            "limit" => parse_as(line, Activity::Limit),
            "view" => parse_as(line, Activity::View),
            "select" => parse_as(line, Activity::Select),
            "dialog" => parse_as(line, Activity::Dialog),
            "help" => parse_as(line, Activity::Help),
            "draft" => parse_as(line, Activity::Draft),
            "question" => parse_as(line, Activity::Question),
            "answer" => parse_as(line, Activity::Answer),
            "lesson" => parse_as(line, Activity::Lesson),
            "look" => parse_as(line, Activity::ExternalRead),
            "xray" => parse_as(line, Activity::Inspection),
            _ => return None,
        })
    }

    /// Returns the fields of the activity, in the order of the line.
    pub(super) fn fields(&self) -> serde_json::Result<Value> {
        match self {
            Activity::Session(presence) => serde_json::to_value(presence),
            Activity::Clock(clock) => serde_json::to_value(clock),
            Activity::Limit(limit) => serde_json::to_value(limit),
            Activity::View(view) => serde_json::to_value(view),
            Activity::Select(select) => serde_json::to_value(select),
            Activity::Dialog(dialog) => serde_json::to_value(dialog),
            Activity::Help(help) => serde_json::to_value(help),
            Activity::Draft(draft) => serde_json::to_value(draft),
            Activity::Question(question) => serde_json::to_value(question),
            Activity::Answer(answer) => serde_json::to_value(answer),
            Activity::Lesson(note) => serde_json::to_value(note),
            Activity::ExternalRead(read) => serde_json::to_value(read),
            Activity::Inspection(inspection) => serde_json::to_value(inspection),
        }
    }
}

/// Returns the fields of an activity, in the order of the line.
impl From<&Activity> for Map<String, Value> {
    fn from(activity: &Activity) -> Self {
        match activity.fields() {
            Ok(Value::Object(fields)) => fields,
            _ => Map::new(),
        }
    }
}
