//! Events of a trajectory, by the kind of their line.
//!
//! Fields are declared in the order in which they are written. Unknown fields are not an error: a parsed line keeps
//! its text, so copies of the line are complete.

mod activity;
mod call;
mod called_tool;
mod lesson;
mod notes;
mod presence;
mod questions;
mod request_id;
mod start;
mod voice;
mod week;

use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

use novamind_base::formatting::json_number;

pub use activity::{
    Activity, DialogOutcome, DialogStep, DialogUse, ExternalRead, HelpRequest, Inspection, ObjectSelection,
    ScreenView, TextEdit, TextEditOutcome,
};
pub use call::{Call, Outcome, RejectionRecord, Reversal, Via};
pub use called_tool::CalledTool;
pub use lesson::{LessonEvent, RecordedLessonEvent};
pub use notes::{Memo, Note, Query, QuerySource};
pub use presence::{Clock, ClockEvent, DetachCause, Limit, LimitEvent, LimitScope, Presence, PresenceEvent};
pub use questions::{QuestionAnswer, QuestionShown};
pub use request_id::RequestId;
pub(crate) use start::first_mechanics;
pub use start::{Parent, Start};
pub use voice::{FailedModelRequest, JudgedPost, ModelTask, RewordedPost, RewordedPosts, VoiceAnswer};
pub use week::{
    Advance, Branch, CalculationOutput, ClosedDays, End, Override, RunEndReason, SubmittedForecast,
    has_naive_forecasts, is_naive_week,
};

/// An event of a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub enum Record {
    /// The first line, with the manifest of the run.
    Start(Box<Start>),
    /// A tool was called in the run.
    Call(Call),
    /// An SQL statement was executed in the database.
    Query(Query),
    /// An activity that does not change the run.
    Activity(Activity),
    /// The player's notes were saved; used in format 1.
    Memo(Memo),
    /// The player's notes were saved.
    Note(Note),
    /// The player submitted a rationale and forecasts for a week.
    Advance(Advance),
    /// A language model responded or failed.
    Voice(VoiceAnswer),
    /// A week was simulated.
    Week(ClosedDays),
    /// Single days of a debug run were simulated.
    Step(ClosedDays),
    /// A parameter was changed in a debug run or a lesson.
    Override(Override),
    /// The copied lines of a branch end before this line.
    Branch(Branch),
    /// The run ended.
    End(End),
    /// An event of a kind that this version does not define, with the name of the kind.
    Unknown(String),
}

impl Record {
    /// Returns the `kind` field of the event's line.
    pub fn kind(&self) -> &str {
        match self {
            Record::Start(_) => "start",
            Record::Call(_) => "call",
            Record::Query(_) => "query",
            Record::Activity(activity) => activity.kind(),
            Record::Memo(_) => "memo",
            Record::Note(_) => "note",
            Record::Advance(_) => "advance",
            Record::Voice(_) => "voice",
            Record::Week(_) => "week",
            Record::Step(_) => "step",
            Record::Override(_) => "override",
            Record::Branch(_) => "branch",
            Record::End(_) => "end",
            Record::Unknown(kind) => kind,
        }
    }

    /// Parses a line of the given kind.
    pub fn parse(kind: &str, line: &[u8]) -> serde_json::Result<Record> {
        Ok(match kind {
            "start" => Record::Start(serde_json::from_slice(line)?),
            "call" => Record::Call(serde_json::from_slice(line)?),
            "query" => Record::Query(serde_json::from_slice(line)?),
            "memo" => Record::Memo(serde_json::from_slice(line)?),
            "note" => Record::Note(serde_json::from_slice(line)?),
            "advance" => Record::Advance(serde_json::from_slice(line)?),
            "voice" => Record::Voice(serde_json::from_slice(line)?),
            "week" => Record::Week(serde_json::from_slice(line)?),
            "step" => Record::Step(serde_json::from_slice(line)?),
            "override" => Record::Override(serde_json::from_slice(line)?),
            "branch" => Record::Branch(serde_json::from_slice(line)?),
            "end" => Record::End(serde_json::from_slice(line)?),
            other => match Activity::parse(other, line) {
                Some(activity) => Record::Activity(activity?),
                None => Record::Unknown(other.to_owned()),
            },
        })
    }

    /// Returns the fields of the event, in the order of the line.
    pub fn fields(&self) -> Map<String, Value> {
        let fields = match self {
            Record::Start(start) => serde_json::to_value(start),
            Record::Call(call) => serde_json::to_value(call),
            Record::Query(query) => serde_json::to_value(query),
            Record::Activity(activity) => activity.fields(),
            Record::Memo(memo) => serde_json::to_value(memo),
            Record::Note(note) => serde_json::to_value(note),
            Record::Advance(advance) => serde_json::to_value(advance),
            Record::Voice(voice_answer) => serde_json::to_value(voice_answer),
            Record::Week(closing) | Record::Step(closing) => serde_json::to_value(closing),
            Record::Override(change) => serde_json::to_value(change),
            Record::Branch(branch) => serde_json::to_value(branch),
            Record::End(end) => serde_json::to_value(end),
            Record::Unknown(_) => Ok(Value::Null),
        };
        match fields {
            Ok(Value::Object(fields)) => fields,
            // Serialization cannot fail: events contain only values that JSON supports.
            _ => Map::new(),
        }
    }

    /// Returns the simulated days that the event closes, if any.
    pub fn closed_days(&self) -> Option<&ClosedDays> {
        match self {
            Record::Week(closing) | Record::Step(closing) => Some(closing),
            _ => None,
        }
    }

    /// Returns the digest of the saved notes, if the event saves notes.
    pub fn notes_digest(&self) -> Option<&str> {
        match self {
            Record::Memo(memo) => Some(&memo.digest),
            Record::Note(note) => Some(&note.digest),
            _ => None,
        }
    }

    /// Returns an accepted call and its result, or `None` for other events.
    pub fn accepted_call(&self) -> Option<(&Call, &Value)> {
        match self {
            Record::Call(call @ Call { outcome: Outcome::Accepted(answer), .. }) => Some((call, answer)),
            _ => None,
        }
    }
}

/// Serializes whole amounts without a decimal point.
fn serialize_shortest<S: Serializer>(number: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    json_number(*number).serialize(serializer)
}

fn serialize_shortest_option<S: Serializer>(number: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    number.map(json_number).serialize(serializer)
}
