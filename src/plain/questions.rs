//! Questions of a study, asked between the commands.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::ending::End;
use super::input::Read;
use super::lines::Lines;
use super::{Style, withdraws};
use novamind_base::notation::printable;
use novamind_record::clock::steady;
use novamind_session::Session;
use novamind_study::{DueQuestion, Form, Study};

/// Asks all questions that are due. Returns the end of the session if the participant leaves before answering all of them.
///
/// # Errors
/// Standard input or output fails.
pub(super) fn ask_due(
    study: &Study,
    session: &mut Session,
    style: Style,
    lines: &mut Lines,
) -> io::Result<Option<End>> {
    let due = study.due(session);
    for (number, question) in due.iter().enumerate() {
        let begins = number == 0 || due[number - 1].questionnaire != question.questionnaire;
        if begins && !style.json {
            println!("== {} ==\n{}", printable(&question.title), printable(question.introduction.trim()));
        }
        question.note_shown(session);
        show(question, style)?;
        if let Some(end) = answer(question, session, style, lines)? {
            return Ok(Some(end));
        }
    }
    Ok(None)
}

/// Reads lines until one is an answer or leaves. Unlike in the console, an answer cannot be changed.
fn answer(
    due: &DueQuestion,
    session: &mut Session,
    style: Style,
    lines: &mut Lines,
) -> io::Result<Option<End>> {
    let shown = steady();
    loop {
        let typed = match lines.read()? {
            Read::End => return Ok(Some(lines.end())),
            Read::Unreadable(problem) => {
                refuse(due, &problem, style)?;
                continue;
            }
            Read::Line(line) => line,
        };
        let value = match typed.trim() {
            "quit" | "exit" => return Ok(Some(End::Quit)),
            "withdraw" if withdraws(style, lines)? => return Ok(Some(End::Withdrawn)),
            "withdraw" => {
                show(due, style)?;
                continue;
            }
            "" if !due.question.required => Ok(Value::Null),
            "" => Err(format!("an answer is required: {}", expected(&due.question.form))),
            typed => due.question.form.value(typed).map_err(|expected| format!("type {expected}")),
        };
        match value {
            Ok(value) => {
                let for_ms = steady().saturating_sub(shown).as_millis() as u64;
                due.note_answer(session, &value, for_ms, 0);
                return Ok(None);
            }
            Err(problem) => refuse(due, &problem, style)?,
        }
    }
}

/// Prints why a line is not an answer.
fn refuse(due: &DueQuestion, problem: &str, style: Style) -> io::Result<()> {
    if style.json {
        println!("{}", json!({ "event": "question_refused", "id": due.question.id, "error": problem }));
    } else {
        println!("{problem}");
    }
    io::stdout().flush()
}

fn show(due: &DueQuestion, style: Style) -> io::Result<()> {
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
        println!("{}", printable(&question.text));
        for line in choices(&question.form) {
            println!("  {}", printable(&line));
        }
        let pass = if question.required { "" } else { ", or an empty line to skip" };
        println!("type {}{pass}; quit leaves, withdraw erases what you did", expected(&question.form));
    }
    io::stdout().flush()
}

/// Returns the choices, one per line.
fn choices(form: &Form) -> Vec<String> {
    match form {
        Form::Likert { points, low, high } => {
            let ends = [(1, low), (*points, high)].into_iter().filter(|(_, words)| !words.is_empty());
            ends.map(|(point, words)| format!("{point} = {words}")).collect()
        }
        Form::Choice { options, .. } | Form::Attention { options, .. } => {
            options.iter().enumerate().map(|(at, option)| format!("{} {option}", at + 1)).collect()
        }
        Form::Number { .. } | Form::Text { .. } => Vec::new(),
    }
}

/// Describes valid answers, as the error for an invalid one does.
fn expected(form: &Form) -> String {
    form.value("").err().unwrap_or_default()
}
