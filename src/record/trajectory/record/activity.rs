//! What a person did besides acting on the company: where they looked, what they opened, typed and left, when they were
//! there. None of it changes the run; a replay passes over it.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::answers::{Answered, Asked};
use super::lesson::LessonNote;
use super::presence::{Clock, Limit, Presence};

/// Something a person did that changes nothing.
#[derive(Debug, Clone, PartialEq)]
pub enum Activity {
    /// The program took up or left the run; the person went away or came back.
    Session(Box<Presence>),
    /// The person stopped the clock or started it again.
    Clock(Clock),
    /// A time limit was near or reached.
    Limit(Limit),
    /// A screen was looked at.
    View(View),
    /// One object was opened: a group, a thread, a tool, a post, a study.
    Select(Select),
    /// A dialog was open.
    Dialog(DialogUse),
    /// A term was explained.
    Help(Help),
    /// A text was edited and sent, or left behind.
    Draft(Draft),
    /// A question of the study was shown.
    Question(Asked),
    /// It was answered, or passed over.
    Answer(Answered),
    /// Something happened in the lesson that the run belongs to.
    Lesson(LessonNote),
    /// The run was read from outside: by a command, without playing.
    Look(Look),
    /// Hidden state was shown.
    Xray(XrayLook),
}

/// A look at a screen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct View {
    /// Screen.
    pub screen: String,
    /// Screen before it; empty if there was none.
    pub from: String,
    /// Milliseconds.
    pub for_ms: u64,
}

/// An object that was opened on a screen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Select {
    /// Screen.
    pub screen: String,
    /// What kind of object: `group`, `thread`, `tool`, `post`, `study`, `table`, `figure`, `command`.
    pub what: String,
    /// Which, as tools and tables name it.
    pub which: String,
}

/// A dialog that was open.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DialogUse {
    /// Which.
    pub what: String,
    /// What became of it.
    pub outcome: DialogOutcome,
    /// Milliseconds it was open.
    pub for_ms: u64,
    /// Milliseconds in each of its steps, in the order in which they were entered.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<DialogStep>,
}

/// What became of a dialog.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DialogOutcome {
    /// What it asked for was confirmed.
    Confirmed,
    /// It was left.
    Cancelled,
}

/// A step of a dialog.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DialogStep {
    /// Which.
    pub step: String,
    /// Milliseconds.
    pub for_ms: u64,
}

/// A term that was explained.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Help {
    /// Term, tool, table or column.
    pub term: String,
    /// Where it was asked for: a screen, a dialog, `plain`.
    pub place: String,
}

/// A text that was edited.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Draft {
    /// Where: `rationale`, `forecasts`, `notes`, `sql`, `post`, or `form` and the tool.
    pub place: String,
    /// What became of it.
    pub outcome: DraftOutcome,
    /// Letters of the text when it was sent or left.
    pub length: u64,
    /// Letters that were typed.
    pub typed: u64,
    /// Letters that were deleted.
    pub deleted: u64,
    /// Letters that came from the clipboard.
    pub pasted: u64,
    /// Pauses of more than two seconds between two keys.
    pub pauses: u32,
    /// Milliseconds from the first key to the last.
    pub for_ms: u64,
    /// The text that was left behind, where the rules keep it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// What became of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DraftOutcome {
    /// It was sent or kept.
    Sent,
    /// It was left behind.
    Left,
    /// It was offered again after the program had been stopped, and taken.
    Restored,
}

/// A command that read the run from outside.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Look {
    /// Command: `query`, `report`, `replay`, `pictures`, `compare`.
    pub command: String,
    /// What it asked for: the statement, the format.
    pub detail: String,
}

/// Hidden state that was shown.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct XrayLook {
    /// What was shown: `leads`, `customer`, `sql` and so on.
    pub what: String,
    /// Of which group, customer or part; the statement of `sql`; empty where there is nothing to choose.
    pub which: String,
    /// The day that was shown.
    pub shown_day: u32,
}

impl Activity {
    /// The kinds that a study can leave out, as lines name them. Looks with the x-ray are always recorded.
    pub const KINDS: [&str; 11] = [
        "session", "clock", "limit", "view", "select", "dialog", "help", "draft", "question", "answer",
        "look",
    ];

    /// Name of the kind.
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
            Activity::Look(_) => "look",
            Activity::Xray(_) => "xray",
        }
    }

    /// Whether the record would lack something that no other line tells: then it is on the disk at once.
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

    /// Reads a line of a kind; none if the kind is no activity.
    pub(super) fn read(kind: &str, line: &[u8]) -> Option<serde_json::Result<Activity>> {
        fn of<'a, T: Deserialize<'a>>(
            line: &'a [u8],
            kind: fn(T) -> Activity,
        ) -> serde_json::Result<Activity> {
            serde_json::from_slice(line).map(kind)
        }
        Some(match kind {
            "session" => of(line, |presence| Activity::Session(Box::new(presence))),
            "clock" => of(line, Activity::Clock),
            "limit" => of(line, Activity::Limit),
            "view" => of(line, Activity::View),
            "select" => of(line, Activity::Select),
            "dialog" => of(line, Activity::Dialog),
            "help" => of(line, Activity::Help),
            "draft" => of(line, Activity::Draft),
            "question" => of(line, Activity::Question),
            "answer" => of(line, Activity::Answer),
            "lesson" => of(line, Activity::Lesson),
            "look" => of(line, Activity::Look),
            "xray" => of(line, Activity::Xray),
            _ => return None,
        })
    }

    /// Its fields, in their order.
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
            Activity::Look(look) => serde_json::to_value(look),
            Activity::Xray(look) => serde_json::to_value(look),
        }
    }
}

/// The fields of an activity as a map, for programs.
impl From<&Activity> for Map<String, Value> {
    fn from(activity: &Activity) -> Self {
        match activity.fields() {
            Ok(Value::Object(fields)) => fields,
            _ => Map::new(),
        }
    }
}
