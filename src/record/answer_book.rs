//! Answered questions of a study, read from the record of a run, and the number of breaks.

use std::collections::BTreeSet;

use crate::trajectory::record::{Activity, Answered, ClockEvent, PresenceEvent};
use crate::trajectory::{Line, Record};

/// The questions of a study that a run has answered.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AnswerBook {
    /// Questionnaire, occasion and question of each answer.
    given: BTreeSet<(String, String, String)>,
    /// Number of times the participant reopened the run or restarted the clock.
    pub breaks: u32,
    /// Whether an `opened` line was read before.
    opened: bool,
}

impl AnswerBook {
    /// Reads the answers and breaks from the lines of a run, in order.
    pub fn of<'a>(lines: impl IntoIterator<Item = &'a Line>) -> AnswerBook {
        let mut book = AnswerBook::default();
        for line in lines {
            if let Record::Activity(activity) = &line.record {
                book.note(activity);
            }
        }
        book
    }

    /// Updates the answers and breaks with one activity.
    pub fn note(&mut self, activity: &Activity) {
        match activity {
            Activity::Answer(answer) => {
                let Answered { questionnaire, occasion, id, .. } = answer.clone();
                self.given.insert((questionnaire, occasion, id));
            }
            Activity::Session(presence) if presence.event == PresenceEvent::Opened => {
                self.breaks += u32::from(self.opened);
                self.opened = true;
            }
            Activity::Clock(clock) if clock.event == ClockEvent::Started => self.breaks += 1,
            _ => {}
        }
    }

    /// Returns whether a question of a questionnaire was answered on an occasion.
    pub fn has(&self, questionnaire: &str, occasion: &str, question: &str) -> bool {
        let place = (questionnaire.to_owned(), occasion.to_owned(), question.to_owned());
        self.given.contains(&place)
    }
}
