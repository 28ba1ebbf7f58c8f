//! The socket between session and script: one JSON value per line, requests from the script and answers from the
//! session.

use std::io::{ErrorKind, Read, Write};
use std::net::Shutdown;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::ScriptRequest;

const MOST_REQUEST: usize = 1 << 20;
/// Time between two attempts to write to a full socket.
const BETWEEN_WRITES: Duration = Duration::from_millis(2);

#[derive(Debug, PartialEq, Eq)]
pub(super) enum Heard {
    /// A request; `None` if the line is not valid.
    Request(Option<ScriptRequest>),
    /// No complete line yet.
    Nothing,
    /// The other end is closed.
    End,
}

#[derive(Debug)]
pub(super) struct Channel {
    socket: UnixStream,
    begun: Vec<u8>,
}

impl Channel {
    /// Creates a channel, and the end for the process.
    ///
    /// # Errors
    /// The system cannot create a socket.
    pub fn pair() -> std::io::Result<(Channel, OwnedFd)> {
        let (socket, other) = UnixStream::pair()?;
        Ok((Channel { socket, begun: Vec::new() }, OwnedFd::from(other)))
    }

    /// Waits for a request, at most `time`.
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

    /// Sends a line. Calls `is_over` before each attempt to write, so that a slow reader cannot delay the end. After
    /// an error nothing more can be sent.
    ///
    /// # Errors
    /// The other end is closed, or `TimedOut` if `is_over` returned true before everything was sent.
    pub fn say(&mut self, message: &Value, is_over: &mut dyn FnMut() -> bool) -> std::io::Result<()> {
        let line = format!("{message}\n");
        // The timeout of a blocking socket restarts after every partial write.
        self.socket.set_nonblocking(true)?;
        let sent = self.send(line.as_bytes(), is_over);
        self.socket.set_nonblocking(false)?;
        sent
    }

    fn send(&mut self, mut bytes: &[u8], is_over: &mut dyn FnMut() -> bool) -> std::io::Result<()> {
        while !bytes.is_empty() {
            if is_over() {
                return Err(ErrorKind::TimedOut.into());
            }
            match self.socket.write(bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(error) if error.kind() == ErrorKind::WouldBlock => sleep(BETWEEN_WRITES),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Closes the socket, so that the script does not wait for an answer.
    pub fn close(&self) {
        // The other end may have closed it already.
        let _ = self.socket.shutdown(Shutdown::Both);
    }
}

/// A socket timeout of zero would wait forever.
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
    fn say_ends_when_it_is_over_however_slowly_the_other_end_reads() {
        let large = Value::from("x".repeat(8 << 20));
        for read_at_once in [0, 1, 1 << 16] {
            let (mut channel, other) = Channel::pair().expect("a socket");
            let mut other = UnixStream::from(other);
            let mut asked = 0;
            let sent = channel.say(&large, &mut || {
                asked += 1;
                other.read_exact(&mut vec![0; if asked > 2 { read_at_once } else { 0 }]).expect("bytes");
                asked == 50
            });
            assert_eq!(sent.map_err(|error| error.kind()), Err(ErrorKind::TimedOut), "{read_at_once}");
            assert_eq!(asked, 50, "{read_at_once}");
        }
    }

    #[test]
    fn say_sends_everything_to_a_slow_reader_while_there_is_time() {
        let (mut channel, other) = Channel::pair().expect("a socket");
        let mut other = UnixStream::from(other);
        let reader = std::thread::spawn(move || {
            let (mut all, mut some) = (Vec::new(), vec![0; 1000]);
            while let Ok(count @ 1..) = other.read(&mut some) {
                all.extend_from_slice(&some[..count]);
            }
            all
        });
        let text = "x".repeat(3 << 20);
        channel.say(&Value::from(text.as_str()), &mut || false).expect("sent");
        drop(channel);
        assert_eq!(reader.join().expect("it ends"), format!("\"{text}\"\n").as_bytes());
    }

    #[test]
    fn hear_ends_at_a_line_without_end() {
        let (mut channel, other) = Channel::pair().expect("a socket");
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
