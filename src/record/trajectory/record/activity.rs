//! Activity of a user that does not change the run: viewed screens, opened objects, typed texts, presence. A replay skips
//! it.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::lesson::LessonNote;
use super::presence::{Clock, Limit, Presence};
use super::questions::{QuestionAnswer, QuestionShown};

/// An activity that does not change the run.
#[derive(Debug, Clone, PartialEq)]
pub enum Activity {
    /// The program attached to or detached from the run, or the user left or returned.
    Session(Box<Presence>),
    /// The user stopped or restarted the clock.
    Clock(Clock),
    /// A time limit approached or was reached.
    Limit(Limit),
    /// A screen was viewed.
    View(ScreenView),
    /// An object was opened: a group, a thread, a tool, a post, a study.
    Select(ObjectSelection),
    /// A dialog was open.
    Dialog(DialogUse),
    /// A term was explained.
    Help(HelpRequest),
    /// A text was edited and sent, or abandoned.
    Draft(TextEdit),
    /// A question of the study was shown.
    Question(QuestionShown),
    /// A question was answered or skipped.
    Answer(QuestionAnswer),
    /// An event of the lesson of the run.
    Lesson(LessonNote),
    /// A command read the run without playing it.
    ExternalRead(ExternalRead),
    /// Hidden state was shown.
    Inspection(Inspection),
}

/// A view of a screen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ScreenView {
    /// Screen.
    pub screen: String,
    /// Previous screen; empty if there was none.
    pub from: String,
    /// Milliseconds.
    pub for_ms: u64,
}

/// An object that was opened on a screen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ObjectSelection {
    /// Screen.
    pub screen: String,
    /// Kind of the object: `group`, `thread`, `tool`, `post`, `study`, `table`, `figure`, `command`.
    pub what: String,
    /// Name of the object in tools and tables.
    pub which: String,
}

/// A dialog that was open.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DialogUse {
    /// Name of the dialog.
    pub what: String,
    /// Outcome.
    pub outcome: DialogOutcome,
    /// Milliseconds for which it was open.
    pub for_ms: u64,
    /// Its steps in the order in which they were entered, with their durations.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<DialogStep>,
}

/// Outcome of a dialog.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DialogOutcome {
    /// The user confirmed it.
    Confirmed,
    /// The user left it.
    Cancelled,
}

/// A step of a dialog.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DialogStep {
    /// Name of the step.
    pub step: String,
    /// Milliseconds.
    pub for_ms: u64,
}

/// A term that was explained.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct HelpRequest {
    /// Term, tool, table or column.
    pub term: String,
    /// Place of the request: a screen, a dialog, `plain`.
    pub place: String,
}

/// A text that was edited.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextEdit {
    /// Place: `rationale`, `forecasts`, `notes`, `sql`, `post`, or `form` and the tool.
    pub place: String,
    /// Outcome.
    pub outcome: TextEditOutcome,
    /// Characters of the text when it was sent or abandoned.
    pub length: u64,
    /// Typed characters.
    pub typed: u64,
    /// Deleted characters.
    pub deleted: u64,
    /// Pasted characters.
    pub pasted: u64,
    /// Number of pauses of more than two seconds between keys.
    pub pauses: u32,
    /// Milliseconds from the first key to the last.
    pub for_ms: u64,
    /// The abandoned text, if the rules keep it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// Outcome of an edited text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TextEditOutcome {
    /// It was sent or saved.
    Sent,
    /// It was abandoned.
    Left,
    /// It was restored after a restart of the program.
    Restored,
}

/// A command that read the run without playing it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ExternalRead {
    /// Command: `query`, `report`, `replay`, `pictures`, `compare`.
    pub command: String,
    /// Details: the statement or the format.
    pub detail: String,
}

/// An inspection of hidden state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inspection {
    /// Kind of the inspection: `leads`, `customer`, `sql` and so on.
    pub what: String,
    /// Group, customer or part, or the statement of `sql`; empty if there is no choice.
    pub which: String,
    /// The day that was shown.
    pub shown_day: u32,
}

impl Activity {
    /// Kinds that a study can exclude from the record. Inspections and lesson events are always recorded.
    pub const OPTIONAL_KINDS: [&str; 11] = [
        "session", "clock", "limit", "view", "select", "dialog", "help", "draft", "question", "answer",
        "look",
    ];

    /// Returns the name of the kind.
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

    /// Returns whether the activity is evidence that no other line has. Such lines are synced at once.
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

    /// Parses a line of a kind. Returns `None` if the kind is not an activity.
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

    /// Returns the fields, in order.
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

/// The fields of an activity, in order.
impl From<&Activity> for Map<String, Value> {
    fn from(activity: &Activity) -> Self {
        match activity.fields() {
            Ok(Value::Object(fields)) => fields,
            _ => Map::new(),
        }
    }
}
