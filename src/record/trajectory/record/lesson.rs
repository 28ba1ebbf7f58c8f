//! Recorded events of a lesson.

use serde::{Deserialize, Serialize};

use super::serialize_shortest_option;

/// A recorded event of a lesson.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordedLessonEvent {
    /// Kind of the event.
    pub event: LessonEvent,
    /// Number of the step within the part, from 1.
    pub step: u32,
    /// Number of the attempt, hint or goal, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub number: Option<u32>,
    /// Name of the triggered pitfall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Guessed or measured value. For choices, the number of the choice, from 1.
    #[serde(default, serialize_with = "serialize_shortest_option", skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Value that the goal requires.
    #[serde(default, serialize_with = "serialize_shortest_option", skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
    /// Whether the goal was reached, or the guess was correct.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub met: Option<bool>,
}

/// Kind of a lesson event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LessonEvent {
    /// The student started a step.
    Begun,
    /// The student answered the question of the step.
    Guess,
    /// The student requested a hint.
    Hint,
    /// The student's decisions triggered a pitfall.
    Pitfall,
    /// The outcome of a guess was measured.
    Outcome,
    /// A goal was checked at the end of the step.
    Goal,
}

impl RecordedLessonEvent {
    /// Returns an event of a step without further fields.
    pub fn new(event: LessonEvent, step: u32) -> RecordedLessonEvent {
        RecordedLessonEvent { event, step, number: None, name: None, value: None, bound: None, met: None }
    }
}
