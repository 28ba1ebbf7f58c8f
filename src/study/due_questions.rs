//! Returns the questions of a study that are due in a run, and records their answers.

use serde_json::{Value, json};

use super::definition::Study;
use super::questions::{Occasion, Question, Questionnaire};
use novamind_record::rules::FreeTextRecording;
use novamind_record::trajectory::record::{Activity, QuestionAnswer, QuestionShown};
use novamind_session::Session;

/// A question that is due.
#[derive(Debug, Clone, PartialEq)]
pub struct DueQuestion {
    /// Name of the questionnaire that contains the question.
    pub questionnaire: String,
    /// Heading of the questionnaire.
    pub title: String,
    /// Text that is shown before the first question of the questionnaire.
    pub introduction: String,
    /// Occasion of the question: `before`, `week N`, `break N` or `end`.
    pub occasion: String,
    /// The question that is due.
    pub question: Question,
}

impl Study {
    /// Returns whether the participant answers questions after the end of a run.
    pub fn has_final_questions(&self, session: &Session) -> bool {
        let is_final = |questionnaire: &Questionnaire| {
            questionnaire.when == Occasion::End && !questionnaire.questions.is_empty()
        };
        is_session_of_study(session) && self.questionnaires.iter().any(is_final)
    }

    /// Returns the questions that are due in a run, in order. A practice run has no questions.
    pub fn due_questions(&self, session: &Session) -> Vec<DueQuestion> {
        if !is_session_of_study(session) {
            return Vec::new();
        }
        let asked = self.questionnaires.iter().flat_map(|questionnaire| {
            due_occasions(questionnaire, session).into_iter().map(move |at| (questionnaire, at))
        });
        asked
            .flat_map(|(questionnaire, occasion)| {
                let open = questionnaire.questions.iter().filter(|question| {
                    !session.log().answered_questions().is_answered(
                        &questionnaire.name,
                        &occasion,
                        &question.id,
                    )
                });
                let due = |question: &Question| DueQuestion {
                    questionnaire: questionnaire.name.clone(),
                    title: questionnaire.title.clone(),
                    introduction: questionnaire.introduction.clone(),
                    occasion: occasion.clone(),
                    question: question.clone(),
                };
                open.map(due).collect::<Vec<_>>()
            })
            .collect()
    }
}

fn is_session_of_study(session: &Session) -> bool {
    session.manifest().study.as_ref().is_some_and(|stamp| !stamp.practice)
}

/// Returns the occasions on which a questionnaire has become due in a run.
fn due_occasions(questionnaire: &Questionnaire, session: &Session) -> Vec<String> {
    let weeks = session.weeks().len() as u32;
    match questionnaire.when {
        Occasion::Before => vec!["before".to_owned()],
        Occasion::Weeks => {
            let due = (1..=weeks).filter(|week| questionnaire.is_due_after(*week));
            due.map(|week| format!("week {week}")).collect()
        }
        Occasion::Break => {
            let last = Some(session.log().answered_questions().break_count)
                .filter(|breaks| *breaks > 0 && session.ended().is_none());
            last.map(|number| format!("break {number}")).into_iter().collect()
        }
        Occasion::End => session.ended().map(|_| "end".to_owned()).into_iter().collect(),
    }
}

impl DueQuestion {
    /// Records that the question was shown to the participant.
    pub fn record_shown(&self, session: &mut Session) {
        session.activity().record(Activity::Question(QuestionShown {
            questionnaire: self.questionnaire.clone(),
            occasion: self.occasion.clone(),
            id: self.question.id.clone(),
            text: self.question.text.clone(),
            form: self.question.form.id().to_owned(),
            options: self.question.form.options(),
        }));
    }

    /// Records the answer to the question. `value` is null if the question was skipped. Free text is masked
    /// if the rules of the session require it. `shown_ms` is the time for which the question was shown, in
    /// milliseconds.
    pub fn record_answer(&self, session: &mut Session, value: &Value, for_ms: u64, changes: u32) {
        let masked =
            session.rules().free_text == FreeTextRecording::Masked && self.question.form.is_free_text();
        let kept = match value.as_str().filter(|_| masked) {
            Some(words) => json!({ "length": words.chars().count() }),
            None => value.clone(),
        };
        session.activity().record(Activity::Answer(QuestionAnswer {
            questionnaire: self.questionnaire.clone(),
            occasion: self.occasion.clone(),
            id: self.question.id.clone(),
            as_expected: self.question.form.matches_expected(value),
            value: kept,
            for_ms,
            changes,
        }));
    }
}
