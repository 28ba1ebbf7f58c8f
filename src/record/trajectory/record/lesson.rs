//! What a student does in a lesson, and what comes of it.

use serde::{Deserialize, Serialize};

use super::shortest_if_any;

/// Something that happened in a lesson.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LessonNote {
    /// What.
    pub event: LessonEvent,
    /// The step, counted from 1.
    pub step: u32,
    /// Which try, hint, or goal it is, counted from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub number: Option<u32>,
    /// Name of a pitfall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// What was guessed or measured; of choices the number of the one taken, counted from 1.
    #[serde(default, serialize_with = "shortest_if_any", skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// What was to be reached.
    #[serde(default, serialize_with = "shortest_if_any", skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
    /// Whether it was reached, or guessed right.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub met: Option<bool>,
}

/// What happened in a lesson.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LessonEvent {
    /// A step began.
    Begun,
    /// The question of the step was answered.
    Guess,
    /// A hint was asked for.
    Hint,
    /// A pitfall was met.
    Pitfall,
    /// What was to be guessed is known.
    Outcome,
    /// A goal was judged.
    Goal,
}

impl LessonNote {
    /// A note about a step that says nothing else yet.
    pub fn about(event: LessonEvent, step: u32) -> LessonNote {
        LessonNote { event, step, number: None, name: None, value: None, bound: None, met: None }
    }
}
