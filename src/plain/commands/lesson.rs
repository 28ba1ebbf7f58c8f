//! `lesson`, `guess`, `hint`, `retry` and `debrief`: the commands of lessons.

use serde_json::{Value, json};

use super::super::grammar::{Argument, ParseError};
use super::super::response::CommandResponse;
use super::{Interpreter, argument_error};
use novamind_course::{
    Debrief, DecisionComparison, FinishedPart, LessonStatus, retry_step, start_part, submit_guess, take_hint,
};
use novamind_report::debrief::debrief_paragraphs;
use novamind_report::lesson::{describe_page, parse_guess};
use novamind_rules::calls_for_waiting_threads;
use novamind_session::Session;
use novamind_tools::Rejection;

impl Interpreter {
    /// Executes `lesson` and `lesson next`.
    pub(super) fn lesson_command(&mut self, arguments: &[Argument]) -> Result<CommandResponse, ParseError> {
        match arguments {
            [] => Ok(self.lesson_page("lesson")),
            [only] if only.key.is_none() && only.value == "next" => Ok(self.next_part()),
            _ => Err(argument_error(arguments, "lesson takes no argument or next")),
        }
    }

    /// Returns the status of the lesson, or a rejection if the run is not part of a lesson.
    fn lesson_page(&mut self, command: &str) -> CommandResponse {
        match LessonStatus::from_session(&mut self.session) {
            Some(page) => {
                CommandResponse::success(command, describe_page(&page).join("\n"), lesson_to_json(&page))
            }
            None => CommandResponse::rejected(command, not_a_lesson_rejection()),
        }
    }

    fn next_part(&mut self) -> CommandResponse {
        let next = LessonStatus::from_session(&mut self.session).map(|page| page.next_part);
        let started = match next {
            None => Err(not_a_lesson_rejection()),
            Some(None) => Err(Rejection::new("no_part", "there is no next part, or this part is not over")),
            Some(Some(part)) => start_part(&self.session, part as usize - 1),
        };
        self.continue_lesson_in("lesson", started)
    }

    /// Executes `guess ANSWER`.
    pub(super) fn run_guess(&mut self, arguments: &[Argument]) -> Result<CommandResponse, ParseError> {
        let [only] = arguments else {
            return Err(argument_error(arguments, "guess takes one answer, for example guess 12000"));
        };
        let written = only.value.as_str().map_or_else(|| only.value.to_string(), str::to_owned);
        if self.session.lesson().is_none() {
            return Ok(CommandResponse::rejected("guess", not_a_lesson_rejection()));
        }
        // If the step has no question, the session rejects every answer.
        let question = LessonStatus::from_session(&mut self.session).and_then(|page| page.question);
        let value = question.map_or(Ok(f64::NAN), |question| parse_guess(&question, &written));
        let value = value.map_err(|text| argument_error(arguments, &text))?;
        Ok(match submit_guess(&mut self.session, value) {
            Ok(()) => self.lesson_page("guess"),
            Err(rejection) => CommandResponse::rejected("guess", rejection),
        })
    }

    /// Executes `hint`.
    pub(super) fn run_hint(&mut self) -> CommandResponse {
        match take_hint(&mut self.session) {
            Ok(text) => CommandResponse::success("hint", text.clone(), json!({ "hint": text })),
            Err(rejection) => CommandResponse::rejected("hint", rejection),
        }
    }

    /// Executes `retry [STEP]`.
    pub(super) fn restart_step(
        &mut self,
        word: &str,
        arguments: &[Argument],
    ) -> Result<CommandResponse, ParseError> {
        let step = match arguments {
            [] => self.session.lesson().map_or(0, |standing| standing.last_started_step()),
            [only] if only.key.is_none() => {
                only.value.as_u64().and_then(|number| (number as usize).checked_sub(1)).ok_or_else(|| {
                    argument_error(arguments, "retry takes the number of a step, for example retry 2")
                })?
            }
            _ => return Err(argument_error(arguments, "retry takes the number of a step or no argument")),
        };
        let again = retry_step(&self.session, step);
        Ok(self.continue_lesson_in(word, again))
    }

    /// Executes `debrief`.
    pub(super) fn debrief(&mut self) -> CommandResponse {
        match FinishedPart::from_session(&self.session) {
            Ok(played) => {
                let debrief = played.debrief(calls_for_waiting_threads);
                CommandResponse::success(
                    "debrief",
                    debrief_paragraphs(&debrief).join("\n"),
                    debrief_to_json(&debrief),
                )
            }
            Err(rejection) => CommandResponse::rejected("debrief", rejection),
        }
    }

    fn continue_lesson_in(&mut self, command: &str, started: Result<Session, Rejection>) -> CommandResponse {
        match started {
            Ok(session) => {
                self.switch_to_run(session);
                self.lesson_page(command)
            }
            Err(rejection) => CommandResponse::rejected(command, rejection),
        }
    }
}

fn not_a_lesson_rejection() -> Rejection {
    Rejection::new(
        "not_in_a_lesson",
        "this run is not part of a lesson; `novamind lesson list` lists the lessons",
    )
}

fn lesson_to_json(page: &LessonStatus) -> Value {
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
        "hints_in_all": page.hint_count,
        "pitfalls": page.pitfalls.iter().map(|(day, say)| json!({ "day": day, "say": say })).collect::<Vec<Value>>(),
        "over": page.is_finished,
        "next_part": page.next_part,
    })
}

fn debrief_to_json(debrief: &Debrief) -> Value {
    let parting = match &debrief.comparison {
        DecisionComparison::Different(parting) => {
            let effect = parting.effect.as_simulated();
            json!({ "week": parting.week, "day": parting.day, "decisions": parting.decisions, "effect": effect })
        }
        DecisionComparison::Same | DecisionComparison::NoDecisions | DecisionComparison::NotComparable => {
            Value::Null
        }
    };
    json!({
        "title": debrief.title,
        "part": debrief.part,
        "seed": debrief.seed,
        "own": debrief.cash_by_day,
        "good": debrief.reference,
        "bad": debrief.bad_play,
        "same_decisions": matches!(debrief.comparison, DecisionComparison::Same),
        "parting": parting,
        "steps": debrief.steps,
        "pitfalls": debrief.pitfalls.iter().map(|(day, say)| json!({ "day": day, "say": say })).collect::<Vec<Value>>(),
        "text": debrief.text,
    })
}
