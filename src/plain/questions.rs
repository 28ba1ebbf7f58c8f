//! Asks the questions of a study between commands.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::end_reason::EndReason;
use super::input::InputLine;
use super::line_source::LineSource;
use super::{OutputStyle, confirm_withdrawal};
use novamind_base::formatting::escape_control_characters;
use novamind_record::clock::monotonic_time;
use novamind_session::Session;
use novamind_study::{AnswerFormat, DueQuestion, Study};

/// Asks all questions that are due. Returns the reason for the end of the session if the participant leaves before
/// answering all questions.
///
/// # Errors
/// Standard input or output fails.
pub(super) fn ask_due_questions(
    study: &Study,
    session: &mut Session,
    style: OutputStyle,
    lines: &mut LineSource,
) -> io::Result<Option<EndReason>> {
    let due = study.due_questions(session);
    for (number, question) in due.iter().enumerate() {
        let begins = number == 0 || due[number - 1].questionnaire != question.questionnaire;
        if begins && !style.json {
            println!(
                "== {} ==\n{}",
                escape_control_characters(&question.title),
                escape_control_characters(question.introduction.trim())
            );
        }
        question.record_shown(session);
        show_question(question, style)?;
        if let Some(end) = ask_question(question, session, style, lines)? {
            return Ok(Some(end));
        }
    }
    Ok(None)
}

/// Reads lines until the participant gives a valid answer or leaves. Unlike in the console, participants
/// cannot change an answer.
fn ask_question(
    due: &DueQuestion,
    session: &mut Session,
    style: OutputStyle,
    lines: &mut LineSource,
) -> io::Result<Option<EndReason>> {
    let shown = monotonic_time();
    loop {
        let typed = match lines.wait_for_line(session)? {
            InputLine::End => return Ok(Some(lines.end_reason())),
            InputLine::Unreadable(problem) => {
                show_invalid_answer(due, &problem, style)?;
                continue;
            }
            InputLine::Line(line) => line,
        };
        let value = match typed.trim() {
            "quit" | "exit" => return Ok(Some(EndReason::Quit)),
            "withdraw" if confirm_withdrawal(style, lines)? => return Ok(Some(EndReason::Withdrawn)),
            "withdraw" => {
                show_question(due, style)?;
                continue;
            }
            "" if !due.question.required => Ok(Value::Null),
            "" => Err(format!("an answer is required: {}", describe_expected_answer(&due.question.form))),
            typed => due.question.form.parse_answer(typed).map_err(|expected| format!("type {expected}")),
        };
        match value {
            Ok(value) => {
                let for_ms = monotonic_time().saturating_sub(shown).as_millis() as u64;
                due.record_answer(session, &value, for_ms, 0);
                return Ok(None);
            }
            Err(problem) => show_invalid_answer(due, &problem, style)?,
        }
    }
}

/// Prints the reason why a line is not a valid answer.
fn show_invalid_answer(due: &DueQuestion, problem: &str, style: OutputStyle) -> io::Result<()> {
    if style.json {
        println!("{}", json!({ "event": "question_refused", "id": due.question.id, "error": problem }));
    } else {
        println!("{problem}");
    }
    io::stdout().flush()
}

fn show_question(due: &DueQuestion, style: OutputStyle) -> io::Result<()> {
    let question = &due.question;
    if style.json {
        let event = json!({
            "event": "question",
            "questionnaire": due.questionnaire,
            "occasion": due.occasion,
            "id": question.id,
            "text": question.text,
            "form": question.form.id(),
            "options": question.form.options(),
            "required": question.required,
        });
        println!("{event}");
    } else {
        println!("{}", escape_control_characters(&question.text));
        for line in list_choices(&question.form) {
            println!("  {}", escape_control_characters(&line));
        }
        let pass = if question.required { "" } else { ", or an empty line to skip" };
        println!(
            "type {}{pass}; or type quit to leave, withdraw to erase your runs of this study",
            describe_expected_answer(&question.form)
        );
    }
    io::stdout().flush()
}

/// Returns the choices of a question, one text per choice.
fn list_choices(form: &AnswerFormat) -> Vec<String> {
    match form {
        AnswerFormat::Likert { points, low, high } => {
            let ends = [(1, low), (*points, high)].into_iter().filter(|(_, words)| !words.is_empty());
            ends.map(|(point, words)| format!("{point} = {words}")).collect()
        }
        AnswerFormat::Choice { options, .. } | AnswerFormat::Attention { options, .. } => {
            options.iter().enumerate().map(|(at, option)| format!("{} {option}", at + 1)).collect()
        }
        AnswerFormat::Number { .. } | AnswerFormat::Text { .. } => Vec::new(),
    }
}

/// Describes valid answers in the same words as the error for an invalid answer.
fn describe_expected_answer(form: &AnswerFormat) -> String {
    form.parse_answer("").err().unwrap_or_default()
}
