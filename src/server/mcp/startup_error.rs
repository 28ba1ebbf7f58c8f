//! Reports an error to a client whose run cannot be opened. Without this error, the client would only see a closed
//! connection.

use std::io::{BufRead, IsTerminal, Write, stdin, stdout};

use serde_json::{Value, json};

/// JSON-RPC error code that is reserved for errors defined by servers.
const SERVER_ERROR: i32 = -32000;

/// Responds with an error to the first request on standard input, which is `initialize`. Returns immediately if
/// standard input is a terminal.
pub fn reject_mcp_client(problem: &str) {
    if stdin().is_terminal() {
        return;
    }
    if let Some(rejection) = error_response(stdin().lock(), problem) {
        let mut out = stdout().lock();
        // Ignore errors, because the client may have closed the connection.
        let _ = writeln!(out, "{rejection}").and_then(|()| out.flush());
    }
}

/// Returns the error response for the first request in `messages`, or `None` if there is no request.
fn error_response(messages: impl BufRead, problem: &str) -> Option<Value> {
    let messages = messages.lines().map_while(Result::ok);
    let id =
        messages.filter_map(|line| serde_json::from_str::<Value>(&line).ok()?.get("id").cloned()).next()?;
    Some(json!({ "jsonrpc": "2.0", "id": id, "error": { "code": SERVER_ERROR, "message": problem } }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_response_has_the_id_of_the_first_request() {
        let messages = "\nnonsense\n{\"method\":\"notifications/x\"}\n{\"id\":7,\"method\":\"initialize\"}\n{\"id\":8}\n";
        let rejection = error_response(messages.as_bytes(), "no such run").expect("an answer");
        assert_eq!((&rejection["id"], &rejection["error"]["message"]), (&json!(7), &json!("no such run")));
        assert_eq!(super::error_response(&b"nonsense"[..], "no such run"), None);
    }
}
