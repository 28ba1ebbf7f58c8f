//! The study questions that a participant has answered and the number of breaks, both read from the record of a run.

use std::collections::BTreeSet;

use crate::trajectory::record::{Activity, ClockEvent, PresenceEvent, QuestionAnswer};
use crate::trajectory::{Line, Record};

/// The study questions that were answered in a run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AnsweredQuestions {
    /// Questionnaire, occasion and question of each answer.
    answers: BTreeSet<(String, String, String)>,
    /// Number of times the participant reopened the run or restarted the clock.
    pub break_count: u32,
    /// Whether an `opened` line has already been read.
    was_opened: bool,
}

impl AnsweredQuestions {
    /// Reads the answers and breaks from the lines of a run, in order.
    pub fn from_lines<'a>(lines: impl IntoIterator<Item = &'a Line>) -> AnsweredQuestions {
        let mut answered_questions = AnsweredQuestions::default();
        for line in lines {
            if let Record::Activity(activity) = &line.record {
                answered_questions.record_activity(activity);
            }
        }
        answered_questions
    }

    /// Updates the answers and the break count from one activity.
    pub fn record_activity(&mut self, activity: &Activity) {
        match activity {
            Activity::Answer(answer) => {
                let QuestionAnswer { questionnaire, occasion, id, .. } = answer.clone();
                self.answers.insert((questionnaire, occasion, id));
            }
            Activity::Session(presence) if presence.event == PresenceEvent::Opened => {
                self.break_count += u32::from(self.was_opened);
                self.was_opened = true;
            }
            Activity::Clock(clock) if clock.event == ClockEvent::Started => self.break_count += 1,
            _ => {}
        }
    }

    /// Returns whether a question of a questionnaire was answered on an occasion.
    pub fn is_answered(&self, questionnaire: &str, occasion: &str, question: &str) -> bool {
        let place = (questionnaire.to_owned(), occasion.to_owned(), question.to_owned());
        self.answers.contains(&place)
    }
}
