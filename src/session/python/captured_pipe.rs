//! Captured output of a process. All bytes are read, but only the start and the end of the output are kept.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Number of bytes that are kept from the start of the output: 5,000 characters of at most 4 bytes.
const MAX_FIRST_BYTES: usize = 4 * 5000;
/// Number of bytes that are kept from the end of the output: 2,000 characters of at most 4 bytes.
const MAX_LAST_BYTES: usize = 4 * 2000;

#[derive(Debug, Default)]
struct CaptureBuffer {
    first: Vec<u8>,
    last: VecDeque<u8>,
}

impl CaptureBuffer {
    fn add(&mut self, bytes: &[u8]) {
        let room = (MAX_FIRST_BYTES - self.first.len()).min(bytes.len());
        self.first.extend_from_slice(&bytes[..room]);
        let end = &bytes[bytes.len().saturating_sub(MAX_LAST_BYTES)..];
        let surplus = (self.last.len() + end.len()).saturating_sub(MAX_LAST_BYTES);
        self.last.drain(..surplus);
        self.last.extend(end);
    }
}

#[derive(Debug)]
pub(super) struct CapturedPipe {
    buffer: Arc<Mutex<CaptureBuffer>>,
    end: Receiver<()>,
}

impl CapturedPipe {
    /// Starts a thread that reads the pipe.
    ///
    /// # Errors
    /// The system cannot create a thread.
    pub fn start(pipe: impl Read + Send + 'static) -> std::io::Result<CapturedPipe> {
        let kept = Arc::<Mutex<CaptureBuffer>>::default();
        let (end_sender, end) = channel();
        let capture_buffer = Arc::clone(&kept);
        thread::Builder::new().name("script output".to_owned()).spawn(move || {
            read_to_end(pipe, &capture_buffer);
            // The send fails if the script was terminated and no thread waits for its output.
            let _ = end_sender.send(());
        })?;
        Ok(CapturedPipe { buffer: kept, end })
    }

    /// Waits for at most `time` until the pipe is closed. Returns whether the pipe was closed in time.
    pub fn closes_within(&self, time: Duration) -> bool {
        self.end.recv_timeout(time) != Err(RecvTimeoutError::Timeout)
    }

    /// Returns the kept start of the output.
    pub fn first_text(&self) -> String {
        String::from_utf8_lossy(&lock_buffer(&self.buffer).first).into_owned()
    }

    /// Returns the last `most` characters of the output.
    pub fn last_text(&self, most: usize) -> String {
        let bytes: Vec<u8> = lock_buffer(&self.buffer).last.iter().copied().collect();
        let text = String::from_utf8_lossy(&bytes);
        let surplus = text.chars().count().saturating_sub(most);
        text.chars().skip(surplus).collect()
    }
}

fn lock_buffer(kept: &Mutex<CaptureBuffer>) -> MutexGuard<'_, CaptureBuffer> {
    kept.lock().unwrap_or_else(PoisonError::into_inner)
}

fn read_to_end(mut pipe: impl Read, kept: &Mutex<CaptureBuffer>) {
    let mut buffer = [0; 1 << 14];
    loop {
        match pipe.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => lock_buffer(kept).add(&buffer[..count]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_and_last_bytes_of_long_output_are_kept() {
        let text: String = (0..200_000).map(|number| format!("{number}\n")).collect();
        let captured = CapturedPipe::start(std::io::Cursor::new(text.clone())).expect("a thread");
        assert!(captured.closes_within(Duration::from_secs(10)));
        assert_eq!(captured.first_text(), text[..MAX_FIRST_BYTES]);
        assert_eq!(captured.last_text(14), "199998\n199999\n");
        assert_eq!(captured.last_text(1 << 20).len(), MAX_LAST_BYTES);
    }

    #[test]
    fn short_output_is_kept_whole() {
        let captured = CapturedPipe::start("one ü".as_bytes()).expect("a thread");
        assert!(captured.closes_within(Duration::from_secs(10)));
        assert_eq!((captured.first_text(), captured.last_text(1)), ("one ü".to_owned(), "ü".to_owned()));
    }
}
