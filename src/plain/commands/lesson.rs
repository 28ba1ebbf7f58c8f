//! `lesson`, `guess`, `hint`, `retry` and `debrief`: a lesson line by line.

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::{Interpreter, problem};
use novamind_course::{
    Debrief, DecisionComparison, LessonPage, PlayedPart, begin_part, guess_in_lesson, take_hint,
    try_step_again,
};
use novamind_report::debrief::in_words;
use novamind_report::lesson::{page_in_words, typed_guess};
use novamind_rules::answers_to_companies;
use novamind_session::Session;
use novamind_tools::Refusal;

impl Interpreter {
    /// `lesson`, `lesson next`
    pub(super) fn lesson(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        match arguments {
            [] => Ok(self.lesson_page("lesson")),
            [only] if only.key.is_none() && only.value == "next" => Ok(self.next_part()),
            _ => Err(problem(arguments, "lesson takes no argument or next")),
        }
    }

    /// Returns the page of the lesson, or the reason why there is none.
    fn lesson_page(&mut self, command: &str) -> Answer {
        match LessonPage::of(&mut self.session) {
            Some(page) => Answer::done(command, page_in_words(&page).join("\n"), as_data(&page)),
            None => Answer::refused(command, no_lesson()),
        }
    }

    fn next_part(&mut self) -> Answer {
        let next = LessonPage::of(&mut self.session).map(|page| page.next_part);
        let begun = match next {
            None => Err(no_lesson()),
            Some(None) => Err(Refusal::new("no_part", "there is no next part, or this one is not over")),
            Some(Some(part)) => begin_part(&self.session, part as usize - 1),
        };
        self.go_to_lesson("lesson", begun)
    }

    /// `guess ANSWER`
    pub(super) fn guess(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        let [only] = arguments else {
            return Err(problem(arguments, "guess takes one answer, for example guess 12000"));
        };
        let written = only.value.as_str().map_or_else(|| only.value.to_string(), str::to_owned);
        if self.session.lesson().is_none() {
            return Ok(Answer::refused("guess", no_lesson()));
        }
        // If the step asks nothing, the session rejects any answer.
        let question = LessonPage::of(&mut self.session).and_then(|page| page.question);
        let value = question.map_or(Ok(f64::NAN), |question| typed_guess(&question, &written));
        let value = value.map_err(|text| problem(arguments, &text))?;
        Ok(match guess_in_lesson(&mut self.session, value) {
            Ok(()) => self.lesson_page("guess"),
            Err(refusal) => Answer::refused("guess", refusal),
        })
    }

    /// `hint`
    pub(super) fn hint(&mut self) -> Answer {
        match take_hint(&mut self.session) {
            Ok(text) => Answer::done("hint", text.clone(), json!({ "hint": text })),
            Err(refusal) => Answer::refused("hint", refusal),
        }
    }

    /// `retry [STEP]`
    pub(super) fn again(&mut self, word: &str, arguments: &[Argument]) -> Result<Answer, Problem> {
        let step = match arguments {
            [] => self.session.lesson().map_or(0, |standing| standing.last_begun()),
            [only] if only.key.is_none() => {
                only.value.as_u64().and_then(|number| (number as usize).checked_sub(1)).ok_or_else(|| {
                    problem(arguments, "retry takes the number of a step, for example retry 2")
                })?
            }
            _ => return Err(problem(arguments, "retry takes the number of a step or no argument")),
        };
        let again = try_step_again(&self.session, step);
        Ok(self.go_to_lesson(word, again))
    }

    /// `debrief`
    pub(super) fn debrief(&mut self) -> Answer {
        match PlayedPart::of(&self.session) {
            Ok(played) => {
                let debrief = played.debrief(answers_to_companies);
                Answer::done("debrief", in_words(&debrief).join("\n"), debrief_as_data(&debrief))
            }
            Err(refusal) => Answer::refused("debrief", refusal),
        }
    }

    fn go_to_lesson(&mut self, command: &str, begun: Result<Session, Refusal>) -> Answer {
        match begun {
            Ok(session) => {
                self.go_on_in(session);
                self.lesson_page(command)
            }
            Err(refusal) => Answer::refused(command, refusal),
        }
    }
}

fn no_lesson() -> Refusal {
    Refusal::new(
        "not_in_a_lesson",
        "this run is not part of a lesson; novamind lesson list shows the lessons",
    )
}

fn as_data(page: &LessonPage) -> Value {
    json!({
        "title": page.title,
        "part": page.part,
        "step": page.step + 1,
        "steps": page.steps,
        "step_title": page.step_title,
        "text": page.text,
        "weeks": { "passed": page.weeks.0, "of": page.weeks.1 },
        "try": page.try_number,
        "question": page.question,
        "goals": page.goals,
        "hints": page.hints,
        "hints_in_all": page.hints_in_all,
        "pitfalls": page.pitfalls.iter().map(|(day, say)| json!({ "day": day, "say": say })).collect::<Vec<Value>>(),
        "over": page.is_over,
        "next_part": page.next_part,
    })
}

fn debrief_as_data(own: &Debrief) -> Value {
    let parting = match &own.comparison {
        DecisionComparison::Parted(parting) => {
            let effect = parting.effect.simulated();
            json!({ "week": parting.week, "day": parting.day, "decisions": parting.decisions, "effect": effect })
        }
        DecisionComparison::Same | DecisionComparison::Nothing | DecisionComparison::Unknown => Value::Null,
    };
    json!({
        "title": own.title,
        "part": own.part,
        "seed": own.seed,
        "own": own.own,
        "good": own.good,
        "bad": own.bad,
        "same_decisions": matches!(own.comparison, DecisionComparison::Same),
        "parting": parting,
        "steps": own.steps,
        "pitfalls": own.pitfalls.iter().map(|(day, say)| json!({ "day": day, "say": say })).collect::<Vec<Value>>(),
        "text": own.text,
    })
}
