//! The same game line by line: for pipes, scripts and screen readers (docs/interfaces/plain-mode.md).
//!
//! One command per line, an answer for each before the next is read, no colour, no cursor movement. Every
//! answer goes to standard output, refusals too, and ends with an empty line.

mod answers;
mod commands;
mod grammar;
mod input;
mod next;
mod questions;
mod signals;
mod visit;

use std::io::{self, BufRead, IsTerminal, Write};

use serde_json::{Value, json};

pub use visit::visit;

pub use crate::database::text::{cell_text, table};

use crate::notation::printable;
use crate::session::record::LeavingCause;
use crate::session::{Interface, Library, Session, Study};
use answers::Answer;
use commands::Interpreter;
use input::{Input, Read};
use signals::{Phase, Watch};

/// How answers look and when the dialogue ends.
#[derive(Debug, Clone, Copy, Default)]
pub struct Style {
    /// One JSON object per line.
    pub json: bool,
    /// Print each input line before its answer.
    pub echo: bool,
    /// End at the first refused or unreadable line.
    pub strict: bool,
}

/// How a dialogue ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Quit,
    InputOver,
    Strict,
    /// The run's file is no longer there.
    RecordLost,
    Signal(i32),
    /// The run of a study is over, and its questions are answered.
    Over,
    /// The person withdrew from the study.
    Withdrawn,
}

impl End {
    fn id(self) -> &'static str {
        match self {
            End::Quit => "quit",
            End::InputOver => "end_of_input",
            End::Strict => "strict",
            End::RecordLost => "record_lost",
            End::Signal(_) => "signal",
            End::Over => "over",
            End::Withdrawn => "withdrawn",
        }
    }

    fn cause(self) -> LeavingCause {
        match self {
            End::Quit | End::Over => LeavingCause::Quit,
            End::InputOver => LeavingCause::EndOfInput,
            End::Strict => LeavingCause::Strict,
            // No line can say it.
            End::RecordLost => LeavingCause::Quit,
            End::Signal(_) => LeavingCause::Signal,
            End::Withdrawn => LeavingCause::Withdrawn,
        }
    }

    fn code(self) -> u8 {
        match self {
            End::Quit | End::InputOver | End::Over | End::Withdrawn => 0,
            End::Strict => 1,
            End::RecordLost => 3,
            End::Signal(number) => 128u8.saturating_add(number as u8),
        }
    }
}

/// Plays on standard input and output; returns the exit code.
///
/// # Errors
/// Standard input or output fails.
pub fn play(session: Session, library: Library, style: Style) -> io::Result<u8> {
    let mut input = Input::new(io::stdin().lock());
    dialogue(session, library, style, None, &mut input).map(|(end, _)| end.code())
}

/// A dialogue about a run, until the person or the input leaves it.
fn dialogue(
    mut session: Session,
    library: Library,
    style: Style,
    study: Option<&Study>,
    input: &mut Input<impl BufRead>,
) -> io::Result<(End, Session)> {
    let prompts = io::stdin().is_terminal();
    session.take_up(Interface { name: "plain", window: None });
    let watch = Watch::start();
    let mut interpreter = Interpreter::new(session, library, watch.clone(), prompts);
    let mut out = io::stdout();
    greet(&mut out, &interpreter.session, style)?;
    let end = loop {
        if let Some(study) = study {
            if !questions::ask_due(study, &mut interpreter.session, style, input)? {
                break End::InputOver;
            }
            if interpreter.session.ended().is_some() {
                break End::Over;
            }
        }
        if prompts {
            prompt(&format!("day {}> ", interpreter.session.day()))?;
        }
        let number = input.next_number();
        watch.enter(Phase::Prompt, farewell(&interpreter.session, style, End::Signal(0)));
        let read = input.read()?;
        watch.enter(Phase::Working, String::new());
        let (line, day) = match read {
            Read::End => break End::InputOver,
            Read::Line(line) => (line, interpreter.session.day()),
            Read::Unreadable(problem) => {
                answer(&mut out, style, number, None, &Answer::usage(problem, 1), interpreter.session.day())?;
                if style.strict {
                    break End::Strict;
                }
                continue;
            }
        };
        if study.is_some() && line.trim() == "withdraw" {
            if withdraws(style, input)? {
                break End::Withdrawn;
            }
            continue;
        }
        let Some(reply) = interpreter.answer(&line, input)? else { continue };
        if reply.is_quit() {
            break End::Quit;
        }
        answer(&mut out, style, number, style.echo.then_some(line.as_str()), &reply, day)?;
        if let Some(signal) = watch.caught() {
            break End::Signal(signal);
        }
        if interpreter.session.record_loss().is_some() {
            break End::RecordLost;
        }
        if style.strict && !reply.is_ok() {
            break End::Strict;
        }
    };
    interpreter.session.leave(end.cause());
    // Everything answered `ok` is on the disk already; what is left are rows that can be made again.
    let _ = interpreter.session.save();
    writeln!(out, "{}", farewell(&interpreter.session, style, end))?;
    out.flush()?;
    Ok((end, interpreter.session))
}

/// Asks whether a participant really withdraws.
fn withdraws(style: Style, input: &mut Input<impl BufRead>) -> io::Result<bool> {
    let question = "Withdrawing erases everything that you did in this study, for good. Type withdraw again to do so, \
                    anything else to go on:";
    if style.json {
        println!("{}", json!({ "event": "ask", "what": "withdraw", "text": question }));
    } else {
        println!("{question}");
    }
    io::stdout().flush()?;
    Ok(matches!(input.read()?, Read::Line(line) if line.trim() == "withdraw"))
}

/// Shows a prompt where a person sees it.
fn prompt(text: &str) -> io::Result<()> {
    let write = |out: &mut dyn Write| out.write_all(text.as_bytes()).and_then(|()| out.flush());
    if io::stdout().is_terminal() { write(&mut io::stdout()) } else { write(&mut io::stderr()) }
}

fn greet(out: &mut io::Stdout, session: &Session, style: Style) -> io::Result<()> {
    let seen = session.observe();
    if style.json {
        let event = json!({
            "event": "start",
            "run": seen.run,
            "seed": seen.seed,
            "day": seen.day,
            "days": seen.last_day,
            "mode": seen.mode,
            "remarks": session.remarks(),
            "dashboard": seen.dashboard,
        });
        writeln!(out, "{event}")?;
    } else {
        let (run, seed, day, days) = (seen.run, seed_in_words(seen.seed), seen.day, seen.last_day);
        writeln!(out, "run {run}{seed} · day {day} of {days} · {}", seen.mode)?;
        for remark in session.remarks() {
            writeln!(out, "note: {remark}")?;
        }
        writeln!(out, "{}", seen.dashboard)?;
    }
    out.flush()
}

/// The seed after the name of a run; nothing where it stays hidden.
fn seed_in_words(seed: Option<u64>) -> String {
    seed.map_or(String::new(), |seed| format!(" · seed {seed}"))
}

fn farewell(session: &Session, style: Style, end: End) -> String {
    let (run, day) = (&session.manifest().id, session.day());
    if style.json {
        json!({ "event": "end", "run": run, "day": day, "reason": end.id() }).to_string()
    } else {
        let done = if session.is_recorded_to_its_end() { "saved" } else { "left" };
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
