//! Which questions of a study are due in a run, and recording them with their answers.

use serde_json::{Value, json};

use super::definition::Study;
use super::questions::{Moment, Question, Questionnaire};
use crate::state::Session;
use novamind_record::rules::FreeText;
use novamind_record::trajectory::record::{Activity, Answered, Asked};

/// A question that is due.
#[derive(Debug, Clone, PartialEq)]
pub struct DueQuestion {
    /// Name of its questionnaire.
    pub questionnaire: String,
    /// What stands above it.
    pub title: String,
    /// What stands before the first question of it.
    pub introduction: String,
    /// When it is asked.
    pub occasion: String,
    /// The question.
    pub question: Question,
}

impl Study {
    /// The questions that are due in a run, in their order.
    pub fn due(&self, session: &Session) -> Vec<DueQuestion> {
        let is_session = session.manifest().study.as_ref().is_some_and(|stamp| !stamp.practice);
        if !is_session {
            return Vec::new();
        }
        let asked = self
            .questionnaires
            .iter()
            .flat_map(|own| occasions(own, session).into_iter().map(move |at| (own, at)));
        asked
            .flat_map(|(own, occasion)| {
                let open = own
                    .questions
                    .iter()
                    .filter(|question| !session.answers.has(&own.name, &occasion, &question.id));
                let due = |question: &Question| DueQuestion {
                    questionnaire: own.name.clone(),
                    title: own.title.clone(),
                    introduction: own.introduction.clone(),
                    occasion: occasion.clone(),
                    question: question.clone(),
                };
                open.map(due).collect::<Vec<_>>()
            })
            .collect()
    }
}

/// When a questionnaire was to be asked by now.
fn occasions(questionnaire: &Questionnaire, session: &Session) -> Vec<String> {
    let weeks = session.weeks().len() as u32;
    match questionnaire.when {
        Moment::Before => vec!["before".to_owned()],
        Moment::Weeks => {
            let due = (1..=weeks).filter(|week| questionnaire.is_due_after(*week));
            due.map(|week| format!("week {week}")).collect()
        }
        Moment::Break => {
            let last = Some(session.answers.breaks).filter(|breaks| *breaks > 0 && session.ended().is_none());
            last.map(|number| format!("break {number}")).into_iter().collect()
        }
        Moment::End => session.ended().map(|_| "end".to_owned()).into_iter().collect(),
    }
}

impl Session {
    /// Records that a question is shown.
    pub fn ask_question(&mut self, due: &DueQuestion) {
        self.note_activity(Activity::Question(Asked {
            questionnaire: due.questionnaire.clone(),
            occasion: due.occasion.clone(),
            id: due.question.id.clone(),
            text: due.question.text.clone(),
            form: due.question.form.id().to_owned(),
            options: due.question.form.options(),
        }));
    }

    /// Records an answer; null where the question was passed over. Words are masked where the rules say so.
    pub fn answer_question(&mut self, due: &DueQuestion, value: &Value, for_ms: u64, changes: u32) {
        let masked = self.rules().free_text == FreeText::Masked && due.question.form.is_in_words();
        let kept = match value.as_str().filter(|_| masked) {
            Some(words) => json!({ "length": words.chars().count() }),
            None => value.clone(),
        };
        self.note_activity(Activity::Answer(Answered {
            questionnaire: due.questionnaire.clone(),
            occasion: due.occasion.clone(),
            id: due.question.id.clone(),
            as_expected: due.question.form.is_as_expected(value),
            value: kept,
            for_ms,
            changes,
        }));
    }
}
