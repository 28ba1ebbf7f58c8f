//! How an answer becomes an exit code.

use serde_json::Value;

use crate::cli::Failure;
use crate::server::Reply;

/// A call, a statement or a week was refused; nothing has changed.
const REFUSED: u8 = 5;
/// Refused, because the run is over.
const OVER: u8 = 6;
/// A week is being simulated, or the server has no room for another connection.
const BUSY: u8 = 7;
/// The server does not answer.
const UNREACHABLE: u8 = 8;

/// What a server that does not answer means.
pub fn unreachable(error: &str) -> Failure {
    Failure::with_code(
        UNREACHABLE,
        format!(
            "the server does not answer: {error}. What was confirmed is kept; `novamind agent status` starts it again and \
             says how far the run has come"
        ),
    )
}

/// Passes what is no refusal.
///
/// # Errors
/// It is one; the message is the code, the argument at fault, and what is wrong.
pub fn check(reply: &Reply) -> Result<(), Failure> {
    if reply.status == 200 && reply.body["success"] != Value::Bool(false) {
        return Ok(());
    }
    let word = |field: &str| reply.body[field].as_str();
    let code = word("code").unwrap_or("error");
    let message = word("error").unwrap_or("the server gave no reason");
    let field = word("field").map(|field| format!(" ({field})")).unwrap_or_default();
    let exit = match (reply.status, code) {
        (_, "run_over") => OVER,
        (409 | 503, _) => BUSY,
        _ => REFUSED,
    };
    Err(Failure::with_code(exit, format!("{code}{field}: {message}")))
}
