//! What the record of a run says about questions of a study: which were answered, and how often the person came back.

use std::collections::BTreeSet;

use crate::trajectory::record::{Activity, Answered, ClockEvent, PresenceEvent};
use crate::trajectory::{Line, Record};

/// What the record of a run says about questions.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AnswerBook {
    /// Questionnaire, occasion and question of each answer.
    given: BTreeSet<(String, String, String)>,
    /// How often the person took up the run again, or started the clock again.
    pub breaks: u32,
    /// The run was taken up before.
    opened: bool,
}

impl AnswerBook {
    /// What lines say, in their order.
    pub fn of<'a>(lines: impl IntoIterator<Item = &'a Line>) -> AnswerBook {
        let mut book = AnswerBook::default();
        for line in lines {
            if let Record::Activity(activity) = &line.record {
                book.note(activity);
            }
        }
        book
    }

    /// Takes note of what a person did.
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

    /// Whether a question of a questionnaire was answered on an occasion.
    pub fn has(&self, questionnaire: &str, occasion: &str, question: &str) -> bool {
        let place = (questionnaire.to_owned(), occasion.to_owned(), question.to_owned());
        self.given.contains(&place)
    }
}
