//! The socket between the session and a script: requests come up, answers go down, a line of JSON each.

use std::io::{ErrorKind, Read, Write};
use std::net::Shutdown;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::time::Duration;

use serde::Deserialize;
use serde_json::Value;

/// A request may have this many bytes.
const MOST_REQUEST: usize = 1 << 20;

/// What a script asks.
#[derive(Debug, PartialEq, Eq, Deserialize)]
#[serde(tag = "ask", rename_all = "lowercase")]
pub(super) enum ScriptRequest {
    /// A statement to the database.
    Query {
        /// The statement.
        sql: String,
    },
    /// Where the run stands.
    Vars,
}

/// What came up.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Heard {
    /// A request; none if the line is none.
    Request(Option<ScriptRequest>),
    /// Nothing yet.
    Nothing,
    /// Nothing any more.
    End,
}

/// The end of the socket that the session holds.
#[derive(Debug)]
pub(super) struct Channel {
    socket: UnixStream,
    /// What came up and is no whole line yet.
    begun: Vec<u8>,
}

impl Channel {
    /// A channel, and the end of it that a process gets.
    ///
    /// # Errors
    /// The system has no socket left.
    pub fn pair() -> std::io::Result<(Channel, OwnedFd)> {
        let (socket, other) = UnixStream::pair()?;
        Ok((Channel { socket, begun: Vec::new() }, OwnedFd::from(other)))
    }

    /// Waits at most this long for a request.
    pub fn hear(&mut self, time: Duration) -> Heard {
        if let Some(request) = self.whole_line() {
            return Heard::Request(request);
        }
        if self.begun.len() > MOST_REQUEST || self.socket.set_read_timeout(Some(at_least(time))).is_err() {
            return Heard::End;
        }
        let mut buffer = [0; 1 << 14];
        match self.socket.read(&mut buffer) {
            Ok(0) => Heard::End,
            Ok(count) => {
                self.begun.extend_from_slice(&buffer[..count]);
                self.whole_line().map_or(Heard::Nothing, Heard::Request)
            }
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => Heard::Nothing,
                _ => Heard::End,
            },
        }
    }

    fn whole_line(&mut self) -> Option<Option<ScriptRequest>> {
        let end = self.begun.iter().position(|byte| *byte == b'\n')?;
        let line: Vec<u8> = self.begun.drain(..=end).collect();
        Some(serde_json::from_slice(&line).ok())
    }

    /// Sends a line down, and waits at most this long until it is taken. After an error nothing more can be sent.
    ///
    /// # Errors
    /// The other end is closed, or does not read.
    pub fn say(&mut self, message: &Value, time: Duration) -> std::io::Result<()> {
        let mut line = message.to_string();
        line.push('\n');
        self.socket.set_write_timeout(Some(at_least(time)))?;
        self.socket.write_all(line.as_bytes())
    }

    /// Hangs up: whoever waits for an answer learns that none will come.
    pub fn close(&self) {
        // It may be closed already.
        let _ = self.socket.shutdown(Shutdown::Both);
    }
}

/// A socket waits without end for no time at all.
fn at_least(time: Duration) -> Duration {
    time.max(Duration::from_millis(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_come_in_pieces_together_and_never() {
        let (mut channel, other) = Channel::pair().expect("a socket");
        let mut other = UnixStream::from(other);
        let mut heard = || channel.hear(Duration::from_millis(5));
        assert_eq!(heard(), Heard::Nothing);
        other.write_all(br#"{"ask":"que"#).expect("written");
        assert_eq!(heard(), Heard::Nothing);
        other.write_all(b"ry\",\"sql\":\"SELECT 1\"}\n{\"ask\":\"vars\"}\nnothing\n").expect("written");
        assert_eq!(heard(), Heard::Request(Some(ScriptRequest::Query { sql: "SELECT 1".to_owned() })));
        assert_eq!(heard(), Heard::Request(Some(ScriptRequest::Vars)));
        assert_eq!(heard(), Heard::Request(None));
        drop(other);
        assert_eq!(heard(), Heard::End);
    }

    #[test]
    fn whoever_does_not_read_or_end_a_line_is_not_waited_for() {
        let (mut channel, other) = Channel::pair().expect("a socket");
        let large = Value::from("x".repeat(8 << 20));
        assert!(channel.say(&large, Duration::from_millis(20)).is_err());
        let mut other = UnixStream::from(other);
        let flood = std::thread::spawn(move || {
            let line = vec![b'x'; 1 << 16];
            while other.write_all(&line).is_ok() {}
        });
        while channel.hear(Duration::from_secs(10)) != Heard::End {}
        drop(channel);
        flood.join().expect("it ends");
    }
}
