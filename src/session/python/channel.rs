//! The socket between session and script. The script sends requests and the session sends answers, one JSON value per
//! line.

use std::io::{ErrorKind, Read, Write};
use std::net::Shutdown;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::ScriptRequest;

const MAX_REQUEST_BYTES: usize = 1 << 20;
/// Time between two attempts to write to a socket whose buffer is full.
const WRITE_RETRY_INTERVAL: Duration = Duration::from_millis(2);

#[derive(Debug, PartialEq, Eq)]
pub(super) enum ChannelEvent {
    /// A request line was received; `None` if the line is not valid.
    Request(Option<ScriptRequest>),
    /// No complete line has been received yet.
    Idle,
    /// The other end of the socket is closed.
    Closed,
}

#[derive(Debug)]
pub(super) struct Channel {
    socket: UnixStream,
    partial_line: Vec<u8>,
}

impl Channel {
    /// Creates a channel, and the end of the socket for the script's process.
    ///
    /// # Errors
    /// The system cannot create a socket.
    pub fn pair() -> std::io::Result<(Channel, OwnedFd)> {
        let (socket, other) = UnixStream::pair()?;
        Ok((Channel { socket, partial_line: Vec::new() }, OwnedFd::from(other)))
    }

    /// Waits for a request from the script, for at most `time`.
    pub fn receive(&mut self, time: Duration) -> ChannelEvent {
        if let Some(request) = self.take_line() {
            return ChannelEvent::Request(request);
        }
        if self.partial_line.len() > MAX_REQUEST_BYTES
            || self.socket.set_read_timeout(Some(nonzero_timeout(time))).is_err()
        {
            return ChannelEvent::Closed;
        }
        let mut buffer = [0; 1 << 14];
        match self.socket.read(&mut buffer) {
            Ok(0) => ChannelEvent::Closed,
            Ok(count) => {
                self.partial_line.extend_from_slice(&buffer[..count]);
                self.take_line().map_or(ChannelEvent::Idle, ChannelEvent::Request)
            }
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => ChannelEvent::Idle,
                _ => ChannelEvent::Closed,
            },
        }
    }

    fn take_line(&mut self) -> Option<Option<ScriptRequest>> {
        let end = self.partial_line.iter().position(|byte| *byte == b'\n')?;
        let line: Vec<u8> = self.partial_line.drain(..=end).collect();
        Some(serde_json::from_slice(&line).ok())
    }

    /// Sends a message as a line. Calls `is_over` before each attempt to write, so that a slow reader cannot delay the
    /// timeout. After an error, the channel cannot send more messages.
    ///
    /// # Errors
    /// The other end of the socket is closed. `TimedOut` if `is_over` returned true before the whole line was sent.
    pub fn send_line(&mut self, message: &Value, is_over: &mut dyn FnMut() -> bool) -> std::io::Result<()> {
        let line = format!("{message}\n");
        // Use a nonblocking socket, because the timeout of a blocking socket restarts after every partial write.
        self.socket.set_nonblocking(true)?;
        let sent = self.write_until(line.as_bytes(), is_over);
        self.socket.set_nonblocking(false)?;
        sent
    }

    fn write_until(&mut self, mut bytes: &[u8], is_over: &mut dyn FnMut() -> bool) -> std::io::Result<()> {
        while !bytes.is_empty() {
            if is_over() {
                return Err(ErrorKind::TimedOut.into());
            }
            match self.socket.write(bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(error) if error.kind() == ErrorKind::WouldBlock => sleep(WRITE_RETRY_INTERVAL),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Closes the socket, so that the script does not wait for an answer.
    pub fn close(&self) {
        // Ignore the error: the other end may have closed the socket already.
        let _ = self.socket.shutdown(Shutdown::Both);
    }
}

/// Returns a timeout of at least 1 ms, because a zero socket timeout is not allowed.
fn nonzero_timeout(time: Duration) -> Duration {
    time.max(Duration::from_millis(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn receive_joins_partial_lines_and_splits_joined_lines() {
        let (mut channel, other) = Channel::pair().expect("a socket");
        let mut other = UnixStream::from(other);
        let mut receive = || channel.receive(Duration::from_millis(5));
        assert_eq!(receive(), ChannelEvent::Idle);
        other.write_all(br#"{"ask":"que"#).expect("written");
        assert_eq!(receive(), ChannelEvent::Idle);
        other.write_all(b"ry\",\"sql\":\"SELECT 1\"}\n{\"ask\":\"vars\"}\nnothing\n").expect("written");
        assert_eq!(
            receive(),
            ChannelEvent::Request(Some(ScriptRequest::Query { sql: "SELECT 1".to_owned() }))
        );
        assert_eq!(receive(), ChannelEvent::Request(Some(ScriptRequest::Vars)));
        assert_eq!(receive(), ChannelEvent::Request(None));
        drop(other);
        assert_eq!(receive(), ChannelEvent::Closed);
    }

    #[test]
    fn send_line_stops_at_the_deadline_despite_slow_reader() {
        let large = Value::from("x".repeat(8 << 20));
        for read_at_once in [0, 1, 1 << 16] {
            let (mut channel, other) = Channel::pair().expect("a socket");
            let mut other = UnixStream::from(other);
            let mut asked = 0;
            let sent = channel.send_line(&large, &mut || {
                asked += 1;
                other.read_exact(&mut vec![0; if asked > 2 { read_at_once } else { 0 }]).expect("bytes");
                asked == 50
            });
            assert_eq!(sent.map_err(|error| error.kind()), Err(ErrorKind::TimedOut), "{read_at_once}");
            assert_eq!(asked, 50, "{read_at_once}");
        }
    }

    #[test]
    fn send_line_sends_everything_to_a_slow_reader() {
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
        channel.send_line(&Value::from(text.as_str()), &mut || false).expect("sent");
        drop(channel);
        assert_eq!(reader.join().expect("it ends"), format!("\"{text}\"\n").as_bytes());
    }

    #[test]
    fn receive_closes_on_an_endless_line() {
        let (mut channel, other) = Channel::pair().expect("a socket");
        let mut other = UnixStream::from(other);
        let flood = std::thread::spawn(move || {
            let line = vec![b'x'; 1 << 16];
            while other.write_all(&line).is_ok() {}
        });
        while channel.receive(Duration::from_secs(10)) != ChannelEvent::Closed {}
        drop(channel);
        flood.join().expect("it ends");
    }
}
