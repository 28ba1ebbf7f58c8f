//! Exit codes for responses of the server.

use serde_json::Value;

use crate::cli::Failure;
use crate::server::ServerResponse;

/// Exit code if a tool call, an SQL statement or a week was rejected. The run is unchanged.
const REJECTED: u8 = 5;
/// Exit code if the request was rejected because the run is over.
const RUN_OVER: u8 = 6;
/// Exit code if a week is being simulated or the server has too many connections.
const BUSY: u8 = 7;
/// Exit code if the server does not respond.
const UNREACHABLE: u8 = 8;

/// Returns the failure for a server that does not respond.
pub fn unreachable_failure(error: &str) -> Failure {
    Failure::with_code(
        UNREACHABLE,
        format!(
            "the server does not respond: {error}. All confirmed actions are saved. `novamind agent status` restarts \
             the server and shows the day of the run"
        ),
    )
}

/// Returns an error if the response is a rejection.
///
/// # Errors
/// The response is a rejection. The message contains the error code, the argument and the reason.
pub fn check_response(reply: &ServerResponse) -> Result<(), Failure> {
    if reply.status == 200 && reply.body["success"] != Value::Bool(false) {
        return Ok(());
    }
    let word = |field: &str| reply.body[field].as_str();
    let code = word("code").unwrap_or("error");
    // In release 2, `error` can be the code, and `message` explains it.
    let message = word("message").or(word("error")).unwrap_or("the server gave no reason");
    let field = word("field").map(|field| format!(" ({field})")).unwrap_or_default();
    let exit = match (reply.status, code) {
        (_, "run_over") => RUN_OVER,
        (409 | 503, _) => BUSY,
        _ => REJECTED,
    };
    Err(Failure::with_code(exit, format!("{code}{field}: {message}")))
}
