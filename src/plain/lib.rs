//! Plain mode: the game line by line, for pipes, scripts and screen readers (docs/interfaces/plain-mode.md).
//!
//! Each line holds one command and is answered before the next one is read. There are no colors and no cursor movements. Every
//! answer, including rejections, goes to standard output and ends with an empty line.

mod answers;
mod commands;
mod ending;
mod grammar;
mod input;
mod lines;
mod next;
mod pause;
mod questions;
mod signals;
mod visit;

use std::io::{self, IsTerminal, Write};

use serde_json::{Value, json};

pub use visit::visit;

pub use novamind_database::text::{cell_text, table};

use answers::Answer;
use commands::Interpreter;
use ending::End;
use input::Read;
use lines::Lines;
use novamind_base::notation::printable;
use novamind_record::folder::library::Library;
use novamind_record::trajectory::record::LeavingCause;
use novamind_session::{Interface, Session};
use novamind_study::Study;

/// Output options of plain mode.
#[derive(Debug, Clone, Copy, Default)]
pub struct Style {
    /// One JSON object per line.
    pub json: bool,
    /// Print each input line before its answer.
    pub echo: bool,
    /// Stop at the first rejected or invalid line.
    pub strict: bool,
}

/// Plays on standard input and output. Returns the exit code.
///
/// # Errors
/// Standard input or output fails.
pub fn play(session: Session, library: Library, style: Style) -> io::Result<u8> {
    let mut lines = Lines::of_standard_input();
    dialogue(session, library, style, None, &mut lines).map(|(end, _)| end.code())
}

/// Answers lines until the player or the input ends.
fn dialogue(
    mut session: Session,
    library: Library,
    style: Style,
    study: Option<&Study>,
    lines: &mut Lines,
) -> io::Result<(End, Session)> {
    session.activity().take_up(Interface { name: "plain", window: None });
    let mut interpreter = Interpreter::new(session, library, lines.watch(), io::stdin().is_terminal());
    interpreter.code_check = study.and_then(Study::code_check);
    interpreter.leads_participant = study.is_some();
    let mut out = io::stdout();
    let end = converse(&mut interpreter, lines, &mut out, style, study);
    // If the output fails, the player has gone.
    interpreter.session.activity().leave(end.as_ref().map_or(LeavingCause::Hangup, |end| end.cause()));
    // Every answer `ok` is already on disk. Only derived rows can be missing, and they can be rebuilt.
    let _ = interpreter.session.save();
    let end = end?;
    if end == End::Withdrawn {
        // The run was erased, so nothing claims that it was saved.
        return Ok((end, interpreter.session));
    }
    let told = writeln!(out, "{}", farewell(&interpreter.session, style, end)).and_then(|()| out.flush());
    match end {
        // The terminal may have gone.
        End::Signal(_) => {}
        _ => told?,
    }
    Ok((end, interpreter.session))
}

fn converse(
    interpreter: &mut Interpreter,
    lines: &mut Lines,
    out: &mut io::Stdout,
    style: Style,
    study: Option<&Study>,
) -> io::Result<End> {
    greet(out, &interpreter.session, style)?;
    if let Some(held) = interpreter.hold_limit() {
        answer(out, style, lines.number(), None, &held, interpreter.session.day())?;
    }
    loop {
        for told in interpreter.check_limits() {
            answer(out, style, lines.number(), None, &told, interpreter.session.day())?;
        }
        if let Some(end) = ask_questions(interpreter, lines, style, study)? {
            return Ok(end);
        }
        if interpreter.prompts && !lines.is_waiting() {
            prompt(&interpreter.prompt_text())?;
        }
        let read = lines.wait(interpreter.patience())?;
        let number = lines.number();
        let (line, day) = match read {
            None => continue,
            Some(Read::End) => return Ok(lines.end()),
            Some(Read::Line(line)) => (line, interpreter.session.day()),
            Some(Read::Unreadable(problem)) => {
                let problem = Answer::usage(problem, 1);
                answer(out, style, number, None, &problem, interpreter.session.day())?;
                if style.strict {
                    return Ok(End::Strict);
                }
                continue;
            }
        };
        if study.is_some() && line.trim() == "withdraw" {
            if withdraws(style, lines)? {
                return Ok(End::Withdrawn);
            }
            let text = "nothing was erased; the study continues".to_owned();
            let reply = Answer::done("withdraw", text, json!({ "withdrawn": false }));
            answer(out, style, number, None, &reply, day)?;
            continue;
        }
        let Some(reply) = interpreter.answer(&line, lines)? else { continue };
        if reply.is_quit() {
            return Ok(End::Quit);
        }
        answer(out, style, number, style.echo.then_some(line.as_str()), &reply, day)?;
        if lines.watch().caught().is_some() {
            return Ok(lines.end());
        }
        if interpreter.session.log().loss().is_some() {
            return Ok(End::RecordLost);
        }
        if style.strict && !reply.is_ok() {
            return Ok(End::Strict);
        }
    }
}

/// Asks the questions of a study that are due. Returns the end of the session if the participant leaves.
fn ask_questions(
    interpreter: &mut Interpreter,
    lines: &mut Lines,
    style: Style,
    study: Option<&Study>,
) -> io::Result<Option<End>> {
    let Some(study) = study.filter(|_| !lines.is_waiting() && !interpreter.session.log().clock_stands())
    else {
        return Ok(None);
    };
    let left = questions::ask_due(study, &mut interpreter.session, style, lines)?;
    Ok(left.or_else(|| interpreter.session.ended().map(|_| End::Over)))
}

/// Asks for confirmation of a withdrawal.
fn withdraws(style: Style, lines: &mut Lines) -> io::Result<bool> {
    let question = "Withdrawing permanently erases your runs of this study. Type withdraw again to confirm, \
                    or anything else to continue:";
    if style.json {
        println!("{}", json!({ "event": "ask", "what": "withdraw", "text": question }));
    } else {
        println!("{question}");
    }
    io::stdout().flush()?;
    Ok(matches!(lines.read()?, Read::Line(line) if line.trim() == "withdraw"))
}

/// Shows a prompt on a stream that the user sees.
fn prompt(text: &str) -> io::Result<()> {
    let write = |out: &mut dyn Write| out.write_all(text.as_bytes()).and_then(|()| out.flush());
    if io::stdout().is_terminal() { write(&mut io::stdout()) } else { write(&mut io::stderr()) }
}

fn greet(out: &mut io::Stdout, session: &Session, style: Style) -> io::Result<()> {
    let seen = session.company().observe();
    let hides_result = session.rules().hide_result(session.ended().is_some());
    let dashboard = if hides_result { "" } else { seen.dashboard.as_str() };
    if style.json {
        let event = json!({
            "event": "start",
            "run": seen.run,
            "seed": seen.seed,
            "day": seen.day,
            "days": seen.last_day,
            "mode": seen.mode,
            "remarks": session.remarks(),
            "dashboard": dashboard,
        });
        writeln!(out, "{event}")?;
    } else {
        let (run, seed, day, days) = (seen.run, seed_in_words(seen.seed), seen.day, seen.last_day);
        writeln!(out, "run {run}{seed} · day {day} of {days} · {}", seen.mode)?;
        for remark in session.remarks() {
            writeln!(out, "note: {remark}")?;
        }
        if !hides_result {
            writeln!(out, "{dashboard}")?;
        }
        writeln!(out, "type help for the commands")?;
    }
    out.flush()
}

/// Returns the seed after the run id, or nothing if it is hidden.
fn seed_in_words(seed: Option<u64>) -> String {
    seed.map_or(String::new(), |seed| format!(" · seed {seed}"))
}

fn farewell(session: &Session, style: Style, end: End) -> String {
    let (run, day) = (&session.manifest().id, session.day());
    if style.json {
        json!({ "event": "end", "run": run, "day": day, "reason": end.id() }).to_string()
    } else {
        let done = if session.log().is_complete() { "saved" } else { "left" };
        format!("{done} run {run} · day {day}")
    }
}

fn answer(
    out: &mut io::Stdout,
    style: Style,
    line: u32,
    echo: Option<&str>,
    reply: &Answer,
    day: u32,
) -> io::Result<()> {
    if style.json {
        let mut object = reply.as_json(line, day);
        if let (Some(text), Value::Object(fields)) = (echo, &mut object) {
            fields.insert("input".to_owned(), text.into());
        }
        writeln!(out, "{object}")?;
    } else {
        if let Some(text) = echo {
            writeln!(out, "> {}", printable(text))?;
        }
        writeln!(out, "{}\n", printable(reply.as_text().trim_end_matches('\n')))?;
    }
    out.flush()
}
