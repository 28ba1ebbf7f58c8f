//! Plain mode: the game line by line, for pipes, scripts and screen readers (docs/interfaces/plain-mode.md).
//!
//! Each line contains one command, and the response is printed before the next line is read. There are no colors and
//! no cursor movements. Every response, including rejections, is printed to standard output and ends with an empty line.

mod advance;
mod commands;
mod end_reason;
mod grammar;
mod input;
mod line_source;
mod participant_session;
mod pause;
mod questions;
mod response;
mod signals;

use std::io::{self, IsTerminal, Write};
use std::path::Path;

use serde_json::{Value, json};

pub use participant_session::{Entrance, run_participant_session};

pub use novamind_database::text::{format_cell, format_result};

pub use commands::parse_tool_call;

use commands::Interpreter;
use end_reason::EndReason;
use input::InputLine;
use line_source::LineSource;
use novamind_base::formatting::{escape_control_characters, pluralize};
use novamind_record::folder::query_library::QueryLibrary;
use novamind_record::trajectory::record::DetachCause;
use novamind_session::{Interface, Session};
use novamind_study::Study;
use response::CommandResponse;

/// Output options of plain mode.
#[derive(Debug, Clone, Copy, Default)]
pub struct OutputStyle {
    /// Whether responses are printed as one JSON object per line.
    pub json: bool,
    /// Whether each input line is printed before the response.
    pub echo: bool,
    /// Whether the session stops at the first rejected or invalid line.
    pub strict: bool,
}

/// Plays on standard input and output. Returns the exit code.
///
/// # Errors
/// Standard input or output fails.
pub fn play(session: Session, library: QueryLibrary, style: OutputStyle) -> io::Result<u8> {
    let mut lines = LineSource::from_stdin();
    run_dialogue(session, library, style, None, &mut lines).map(|(end, _)| end.exit_code())
}

/// A participant of a study who plays a run.
#[derive(Debug, Clone, Copy)]
struct Participant<'a> {
    study: &'a Study,
    /// Folder of the runs on this machine.
    runs: &'a Path,
    is_hosted: bool,
}

/// Executes lines until the player leaves or the input ends.
fn run_dialogue(
    mut session: Session,
    library: QueryLibrary,
    style: OutputStyle,
    participant: Option<Participant<'_>>,
    lines: &mut LineSource,
) -> io::Result<(EndReason, Session)> {
    let study = participant.map(|participant| participant.study);
    session.activity().attach(Interface { name: "plain", window: None });
    let mut interpreter = Interpreter::new(session, library, lines.signal_watch(), io::stdin().is_terminal());
    interpreter.code_check =
        participant.and_then(|participant| participant.study.code_check(participant.runs));
    interpreter.is_participant = study.is_some();
    interpreter.is_hosted = participant.is_some_and(|participant| participant.is_hosted);
    interpreter.has_final_questions =
        study.is_some_and(|study| study.has_final_questions(&interpreter.session));
    let mut out = io::stdout();
    let mut unsaved = 0;
    let end = command_loop(&mut interpreter, lines, &mut out, style, study, &mut unsaved);
    // An output error means that the terminal was closed or that the reader of the output has ended.
    interpreter
        .session
        .activity()
        .detach(end.as_ref().map_or(DetachCause::Hangup, |end| end.leaving_cause()));
    // Every confirmed change is already on disk. If saving fails, only derived rows are missing, and the
    // program can rebuild them.
    let _ = interpreter.session.save();
    let end = end?;
    if end == EndReason::Withdrawn {
        // The run was erased, so do not print that it was saved.
        return Ok((end, interpreter.session));
    }
    let farewell =
        writeln!(out, "{}", farewell_text(&interpreter.session, style, end)).and_then(|()| out.flush());
    match end {
        // The terminal may be closed, so ignore output errors.
        EndReason::Signal(_) => {}
        _ => farewell?,
    }
    if unsaved > 0 && study.is_none() && end.exit_code() == 0 {
        let lines = pluralize(unsaved, "line");
        return Err(io::Error::other(format!(
            "{lines} had no effect, because the record could not be written; every line that was answered with ok is saved"
        )));
    }
    Ok((end, interpreter.session))
}

fn command_loop(
    interpreter: &mut Interpreter,
    lines: &mut LineSource,
    out: &mut io::Stdout,
    style: OutputStyle,
    study: Option<&Study>,
    unsaved: &mut u32,
) -> io::Result<EndReason> {
    let asks_first = study.is_some_and(|study| {
        interpreter.session.ended().is_some() && !study.due_questions(&interpreter.session).is_empty()
    });
    greet(out, &interpreter.session, style, asks_first)?;
    if asks_first && !interpreter.session.rules().hides_result(true) {
        let text = interpreter.session.company().observe().dashboard;
        let data = json!({ "dashboard": text });
        interpreter.held_result = Some(CommandResponse::success("dashboard", text, data));
    }
    if let Some(command_response) = interpreter.restore_limit_pause() {
        print_response(out, style, lines.line_number(), None, &command_response, interpreter.session.day())?;
    }
    loop {
        for response in interpreter.check_limits() {
            print_response(out, style, lines.line_number(), None, &response, interpreter.session.day())?;
        }
        if let Some(end) = ask_questions(interpreter, lines, style, study)? {
            let result = interpreter.held_result.take().filter(|_| end == EndReason::RunOver);
            if let Some(result) = result {
                print_response(out, style, lines.line_number(), None, &result, interpreter.session.day())?;
            }
            return Ok(end);
        }
        if interpreter.is_interactive && !lines.is_waiting() {
            show_prompt(&interpreter.prompt_text())?;
        }
        let timeout = interpreter.limit_check_timeout();
        let read = lines.read_watched_line(&mut interpreter.session, timeout)?;
        let number = lines.line_number();
        let (line, day) = match read {
            None => continue,
            Some(InputLine::End) => return Ok(lines.end_reason()),
            Some(InputLine::Line(line)) => (line, interpreter.session.day()),
            Some(InputLine::Unreadable(problem)) => {
                let problem = CommandResponse::syntax_error(problem, 1);
                print_response(out, style, number, None, &problem, interpreter.session.day())?;
                if style.strict {
                    return Ok(EndReason::StrictRejection);
                }
                continue;
            }
        };
        if study.is_some() && line.trim() == "withdraw" {
            if confirm_withdrawal(style, lines)? {
                return Ok(EndReason::Withdrawn);
            }
            let text = "nothing was erased; the study continues".to_owned();
            let reply = CommandResponse::success("withdraw", text, json!({ "withdrawn": false }));
            print_response(out, style, number, None, &reply, day)?;
            continue;
        }
        let Some(reply) = interpreter.execute_line(&line, lines)? else { continue };
        if reply.is_quit() {
            return Ok(EndReason::Quit);
        }
        *unsaved += u32::from(reply.is_not_saved());
        print_response(out, style, number, style.echo.then_some(line.as_str()), &reply, day)?;
        if lines.signal_watch().caught_signal().is_some() {
            return Ok(lines.end_reason());
        }
        if interpreter.session.log().loss_reason().is_some() {
            return Ok(EndReason::RecordLost);
        }
        if style.strict && !reply.is_success() {
            return Ok(EndReason::StrictRejection);
        }
    }
}

/// Asks the study questions that are due. Returns the end of the session if the participant leaves.
fn ask_questions(
    interpreter: &mut Interpreter,
    lines: &mut LineSource,
    style: OutputStyle,
    study: Option<&Study>,
) -> io::Result<Option<EndReason>> {
    let Some(study) = study.filter(|_| !lines.is_waiting() && !interpreter.session.log().is_clock_stopped())
    else {
        return Ok(None);
    };
    let left = questions::ask_due_questions(study, &mut interpreter.session, style, lines)?;
    Ok(left.or_else(|| interpreter.session.ended().map(|_| EndReason::RunOver)))
}

/// Asks for confirmation of a withdrawal.
fn confirm_withdrawal(style: OutputStyle, lines: &mut LineSource) -> io::Result<bool> {
    let question = "Withdrawing permanently erases your runs of this study. Type withdraw again to confirm, \
                    or anything else to continue:";
    if style.json {
        println!("{}", json!({ "event": "ask", "what": "withdraw", "text": question }));
    } else {
        println!("{question}");
    }
    io::stdout().flush()?;
    Ok(matches!(lines.read_line()?, InputLine::Line(line) if line.trim() == "withdraw"))
}

/// Writes a prompt to an output stream that is visible to the user.
fn show_prompt(text: &str) -> io::Result<()> {
    let write = |out: &mut dyn Write| out.write_all(text.as_bytes()).and_then(|()| out.flush());
    if io::stdout().is_terminal() { write(&mut io::stdout()) } else { write(&mut io::stderr()) }
}

/// Prints the run and its dashboard. The dashboard of a run that has ended follows the final questions.
fn greet(out: &mut io::Stdout, session: &Session, style: OutputStyle, asks_first: bool) -> io::Result<()> {
    let seen = session.company().observe();
    let hides_result = asks_first || session.rules().hides_result(session.ended().is_some());
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
        let (run, seed, day, days) = (seen.run, describe_seed(seen.seed), seen.day, seen.last_day);
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

/// Formats the seed that follows the run id. Returns an empty text if the seed is hidden.
fn describe_seed(seed: Option<u64>) -> String {
    seed.map_or(String::new(), |seed| format!(" · seed {seed}"))
}

fn farewell_text(session: &Session, style: OutputStyle, end: EndReason) -> String {
    let (run, day) = (&session.manifest().id, session.day());
    if style.json {
        json!({ "event": "end", "run": run, "day": day, "reason": end.id() }).to_string()
    } else {
        let done = if session.log().is_complete() { "saved" } else { "left" };
        format!("{done} run {run} · day {day}")
    }
}

fn print_response(
    out: &mut io::Stdout,
    style: OutputStyle,
    line: u32,
    echo: Option<&str>,
    reply: &CommandResponse,
    day: u32,
) -> io::Result<()> {
    if style.json {
        let mut object = reply.to_json(line, day);
        if let (Some(text), Value::Object(fields)) = (echo, &mut object) {
            fields.insert("input".to_owned(), text.into());
        }
        writeln!(out, "{object}")?;
    } else {
        if let Some(text) = echo {
            writeln!(out, "> {}", escape_control_characters(text))?;
        }
        writeln!(out, "{}\n", escape_control_characters(reply.to_text().trim_end_matches('\n')))?;
    }
    out.flush()
}
