//! Running a script in Python: what the session answers it, and what its end tells the player.

use std::io::ErrorKind;
use std::os::unix::process::ExitStatusExt;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::channel::ScriptRequest;
use super::failed;
use super::interpreter::Interpreter;
use super::process::{ScriptEnd, ScriptProcess};
use crate::ask::rows_as_json;
use crate::play::scripts::Said;
use crate::state::Session;
use novamind_database::Rows;
use novamind_database::query::Limits;
use novamind_record::trajectory::record::QuerySource;
use novamind_tools::Refusal;

/// Statements that one script may ask.
const MOST_QUERIES: u32 = 10_000;
/// Characters of the end of a traceback that a refusal tells.
const MOST_TRACEBACK: usize = 2000;
/// Characters of what was printed before that.
const MOST_PRINTED: usize = 1000;

impl Session {
    /// What a script in Python says. Its statements are lines of the record where they are `noted`.
    ///
    /// # Errors
    /// `script_failed`, `script_timeout`.
    pub(crate) fn run_python(&mut self, code: &str, time: Duration, noted: bool) -> Result<Said, Refusal> {
        let stop = self.interrupt().map_err(|refusal| failed(refusal.message))?;
        let ticket = stop.ticket();
        let interpreter = Interpreter::of(self.manifest.mode);
        let started = ScriptProcess::start(code, interpreter, time);
        let mut process = started.map_err(|error| not_started(interpreter, &error))?;
        let mut asked = 0;
        let end = process.serve(&|| stop.has_stopped(ticket), &mut |request, left| {
            asked += 1;
            let answer = match asked <= MOST_QUERIES {
                true => self.answer_script(request, left, noted),
                false => {
                    Err(Refusal::new("sql_error", "a script may ask 10,000 times; ask for more at once"))
                }
            };
            answer.unwrap_or_else(
                |refusal| json!({ "error": { "code": refusal.code, "message": refusal.message } }),
            )
        });
        told(&end, &process, time)
    }

    fn answer_script(
        &mut self,
        request: Option<ScriptRequest>,
        left: Duration,
        noted: bool,
    ) -> Result<Value, Refusal> {
        match request {
            Some(ScriptRequest::Vars) => Ok(json!({ "current_day": self.day() })),
            Some(ScriptRequest::Query { sql }) => {
                self.query_of_script(&sql, left, noted).map(|rows| Value::Object(rows_as_json(&rows)))
            }
            None => Err(Refusal::new("sql_error", "a script can ask query(sql) and get_vars()")),
        }
    }

    fn query_of_script(&mut self, sql: &str, left: Duration, noted: bool) -> Result<Rows, Refusal> {
        let started = Instant::now();
        let own = self.query_limits();
        let limits = Limits { time: own.time.min(left), ..own };
        let ticket = self.interrupt()?.ticket();
        let answer = self.answer_within(ticket, sql, limits);
        if noted {
            self.note_query(sql, answer.as_ref(), started.elapsed(), QuerySource::Script);
        }
        answer
    }
}

fn not_started(interpreter: Interpreter, error: &std::io::Error) -> Refusal {
    match error.kind() {
        ErrorKind::NotFound => failed(interpreter.missing()),
        _ => failed(format!("python3 cannot be started: {error}")),
    }
}

/// What the player is told of a script that has ended.
fn told(end: &ScriptEnd, process: &ScriptProcess, time: Duration) -> Result<Said, Refusal> {
    match end {
        ScriptEnd::Ended(status) if status.success() => {
            Ok(Said { results: process.stdout.first(), remarks: process.stderr.first() })
        }
        ScriptEnd::Ended(status) => {
            let how = match (status.code(), status.signal()) {
                (Some(code), _) => format!("python3 ended with code {code}"),
                (None, signal) => format!("python3 was ended by signal {}", signal.unwrap_or_default()),
            };
            let traceback = process.stderr.last(MOST_TRACEBACK);
            // The error itself stands last; whoever shows one line shows that.
            let what = traceback.trim_end().lines().next_back().filter(|line| !line.trim().is_empty());
            let what = what.map_or_else(|| how.clone(), |what| format!("{}; {how}", what.trim()));
            Err(failed(format!("{what}{}{}", part("", &traceback), printed(process))))
        }
        ScriptEnd::TimedOut => {
            let seconds = novamind_base::notation::grouped((10.0 * time.as_secs_f64()).round() / 10.0, 1);
            let seconds = seconds.trim_end_matches(".0");
            let message = format!("it did not end in {seconds} s and was stopped{}", printed(process));
            Err(Refusal::at("code", "script_timeout", message))
        }
        ScriptEnd::Stopped => {
            let message = format!("the script was cancelled{}", printed(process));
            Err(Refusal::at("code", "script_timeout", message))
        }
    }
}

fn printed(process: &ScriptProcess) -> String {
    part("before that it printed:\n", &process.stdout.last(MOST_PRINTED))
}

/// A paragraph of a message; nothing where there is nothing to say.
fn part(heading: &str, text: &str) -> String {
    match text.trim_end() {
        "" => String::new(),
        text => format!("\n{heading}{text}"),
    }
}
