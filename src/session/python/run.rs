//! Execution of a Python script, and its result for the player.

use std::io::ErrorKind;
use std::os::unix::process::ExitStatusExt;
use std::time::Duration;

use serde_json::json;

use super::interpreter::Interpreter;
use super::process::{ScriptEnd, ScriptProcess};
use super::{RawScriptOutput, ScriptHost, script_failed};
use novamind_record::mode::Mode;
use novamind_tools::Rejection;

const MAX_QUERIES: u32 = 10_000;
const MAX_TRACEBACK_CHARACTERS: usize = 2000;
/// Maximum length of printed output in a rejection, in characters.
const MAX_PRINTED_CHARACTERS: usize = 1000;

/// Executes a Python script and returns its output.
///
/// # Errors
/// One of the rejections `script_failed`, `script_timeout`.
pub(crate) fn run_python(
    code: &str,
    time: Duration,
    mode: Mode,
    host: &mut ScriptHost<'_>,
) -> Result<RawScriptOutput, Rejection> {
    let interpreter = Interpreter::for_mode(mode);
    let started = ScriptProcess::start(code, interpreter, time);
    let mut process = started.map_err(|error| start_error(interpreter, &error))?;
    let mut asked = 0;
    let ScriptHost { is_stopped, answer } = host;
    let end = process.serve(is_stopped, &mut |request, left| {
        asked += 1;
        let answer = match request {
            _ if asked > MAX_QUERIES => Err(Rejection::new(
                "sql_error",
                "a script can send 10,000 queries; select more rows per query",
            )),
            Some(request) => answer(request, left),
            None => Err(Rejection::new("sql_error", "a script can call query(sql) and get_vars()")),
        };
        answer.unwrap_or_else(
            |rejection| json!({ "error": { "code": rejection.code, "message": rejection.message } }),
        )
    });
    script_result(&end, &process, time)
}

fn start_error(interpreter: Interpreter, error: &std::io::Error) -> Rejection {
    match error.kind() {
        ErrorKind::NotFound => script_failed(interpreter.missing_message()),
        _ => script_failed(format!("python3 cannot be started: {error}")),
    }
}

fn script_result(
    end: &ScriptEnd,
    process: &ScriptProcess,
    time: Duration,
) -> Result<RawScriptOutput, Rejection> {
    match end {
        ScriptEnd::Ended(status) if status.success() => Ok(RawScriptOutput {
            results: process.without_folder(process.stdout.first_text()),
            remarks: process.without_folder(process.stderr.first_text()),
        }),
        ScriptEnd::Ended(status) => {
            let how = match (status.code(), status.signal()) {
                (Some(code), _) => format!("python3 ended with code {code}"),
                (None, signal) => format!("python3 was terminated by signal {}", signal.unwrap_or_default()),
            };
            let traceback = process.without_folder(process.stderr.last_text(MAX_TRACEBACK_CHARACTERS));
            // The last line of the traceback is the error message. Put this message first, because some displays show
            // only one line.
            let what = traceback.trim_end().lines().next_back().filter(|line| !line.trim().is_empty());
            let what = what.map_or_else(|| how.clone(), |what| format!("{}; {how}", what.trim()));
            Err(script_failed(format!(
                "{what}{}{}",
                paragraph("", &traceback),
                printed_output_paragraph(process)
            )))
        }
        ScriptEnd::TimedOut => {
            let seconds =
                novamind_base::formatting::grouped_number((10.0 * time.as_secs_f64()).round() / 10.0, 1);
            let seconds = seconds.trim_end_matches(".0");
            let message = format!(
                "the script did not end in {seconds} s and was stopped{}",
                printed_output_paragraph(process)
            );
            Err(Rejection::for_field("code", "script_timeout", message))
        }
        ScriptEnd::Stopped => {
            let message = format!("the script was cancelled{}", printed_output_paragraph(process));
            Err(Rejection::for_field("code", "script_timeout", message))
        }
    }
}

fn printed_output_paragraph(process: &ScriptProcess) -> String {
    paragraph(
        "output of the script:\n",
        &process.without_folder(process.stdout.last_text(MAX_PRINTED_CHARACTERS)),
    )
}

/// Returns a paragraph of a message, or an empty string if `text` is empty.
fn paragraph(heading: &str, text: &str) -> String {
    match text.trim_end() {
        "" => String::new(),
        text => format!("\n{heading}{text}"),
    }
}
