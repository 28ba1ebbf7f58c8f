//! Connects the protocol to standard input and output. A line that is not valid JSON is answered with a parse error.
//!
//! The protocol library would drop such lines, so that the client would wait forever.

use serde_json::{Value, json};
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader, DuplexStream, duplex};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::task::JoinHandle;

use crate::non_finite;

/// Size in bytes of the buffers between the protocol library and standard input and output.
const BUFFER_BYTES: usize = 64 * 1024;
/// Maximum size of a message in bytes.
const MAX_MESSAGE_BYTES: usize = 16 * 1024 * 1024;

/// Opens standard input and output for the protocol. The returned task ends when all output is written.
pub fn open() -> ((DuplexStream, DuplexStream), JoinHandle<()>) {
    let (input, forward) = duplex(BUFFER_BYTES);
    let (output, answers) = duplex(BUFFER_BYTES);
    let (problems, answered) = unbounded_channel();
    tokio::spawn(forward_lines(forward, problems));
    let writing = tokio::spawn(write_lines(answers, answered));
    ((input, output), writing)
}

/// Forwards each valid JSON line to the protocol library until the input ends.
async fn forward_lines(mut forward: DuplexStream, problems: UnboundedSender<String>) {
    let mut input = BufReader::new(tokio::io::stdin());
    let mut line = Vec::new();
    loop {
        line.clear();
        let mut bounded = (&mut input).take(MAX_MESSAGE_BYTES as u64 + 1);
        if !matches!(bounded.read_until(b'\n', &mut line).await, Ok(1..)) {
            return;
        }
        if line.len() > MAX_MESSAGE_BYTES {
            let message = format!("the message is longer than {MAX_MESSAGE_BYTES} bytes");
            let _ = problems.send(parse_error(&Value::Null, &message));
            skip_line(&mut input).await;
            continue;
        }
        if line.trim_ascii().is_empty() {
            continue;
        }
        // Parsing to a value applies the same depth limit as the protocol library.
        match serde_json::from_slice::<Value>(&line) {
            Ok(_) => {
                if forward.write_all(&line).await.is_err() {
                    return;
                }
            }
            Err(error) => {
                let problem = match non_finite::parse_with_non_finite_numbers(&line) {
                    Some((message, rejection)) => parse_error(&message["id"], &rejection.message),
                    None => parse_error(&Value::Null, &format!("the message is not valid JSON: {error}")),
                };
                let _ = problems.send(problem);
            }
        }
    }
}

/// Skips the rest of a line without storing the whole line in memory.
async fn skip_line(input: &mut BufReader<tokio::io::Stdin>) {
    let mut piece = Vec::new();
    loop {
        piece.clear();
        match input.take(BUFFER_BYTES as u64).read_until(b'\n', &mut piece).await {
            Ok(1..) if piece.last() != Some(&b'\n') => {}
            _ => return,
        }
    }
}

/// Writes protocol messages and parse errors, each on a separate line.
async fn write_lines(answers: DuplexStream, mut problems: UnboundedReceiver<String>) {
    let mut output = tokio::io::stdout();
    let mut answers = BufReader::new(answers).lines();
    loop {
        let line = tokio::select! {
            line = answers.next_line() => match line {
                Ok(Some(line)) => line,
                _ => return,
            },
            Some(problem) = problems.recv() => problem,
        };
        let written = output.write_all(format!("{line}\n").as_bytes()).await;
        if written.is_err() || output.flush().await.is_err() {
            return;
        }
    }
}

/// Returns the parse error for a message. `id` is the id of the message, or null if the message could not be parsed.
fn parse_error(id: &Value, message: &str) -> String {
    json!({ "jsonrpc": "2.0", "id": id, "error": { "code": -32700, "message": message } }).to_string()
}
