//! What happened in a lesson, in words.

use crate::notation::compact;
use crate::session::{LessonEvent, LessonNote};

/// The word of an event, as lines write it.
pub fn word(event: LessonEvent) -> &'static str {
    match event {
        LessonEvent::Begun => "begun",
        LessonEvent::Guess => "guess",
        LessonEvent::Hint => "hint",
        LessonEvent::Pitfall => "pitfall",
        LessonEvent::Outcome => "outcome",
        LessonEvent::Goal => "goal",
    }
}

/// A line of kind `lesson` in words, for those who have not the lesson at hand.
pub fn in_words(note: &LessonNote) -> String {
    let number = note.number.unwrap_or(1);
    let value = note.value.map(compact).unwrap_or_else(|| "none".to_owned());
    match note.event {
        LessonEvent::Begun if number > 1 => format!("step {} began, try {number}", note.step),
        LessonEvent::Begun => format!("step {} began", note.step),
        LessonEvent::Guess => format!("step {}: guessed {value}", note.step),
        LessonEvent::Hint => format!("step {}: hint {number}", note.step),
        LessonEvent::Pitfall => format!("step {}: pitfall {}", note.step, note.name.as_deref().unwrap_or("")),
        LessonEvent::Outcome => format!("step {}: the outcome was {value}", note.step),
        LessonEvent::Goal => {
            let met = if note.met == Some(true) { "reached" } else { "missed" };
            format!("step {}: goal {number} {met} with {value}", note.step)
        }
    }
}
