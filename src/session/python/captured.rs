//! Captured output of a process: reads everything, keeps the start and the end.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Bytes kept from the start: 5,000 characters of at most 4 bytes.
const FIRST: usize = 4 * 5000;
/// Bytes kept from the end: 2,000 characters of at most 4 bytes.
const LAST: usize = 4 * 2000;

#[derive(Debug, Default)]
struct Kept {
    first: Vec<u8>,
    last: VecDeque<u8>,
}

impl Kept {
    fn add(&mut self, bytes: &[u8]) {
        let room = (FIRST - self.first.len()).min(bytes.len());
        self.first.extend_from_slice(&bytes[..room]);
        let end = &bytes[bytes.len().saturating_sub(LAST)..];
        let surplus = (self.last.len() + end.len()).saturating_sub(LAST);
        self.last.drain(..surplus);
        self.last.extend(end);
    }
}

#[derive(Debug)]
pub(super) struct Captured {
    kept: Arc<Mutex<Kept>>,
    end: Receiver<()>,
}

impl Captured {
    /// Starts to read.
    ///
    /// # Errors
    /// The system cannot create a thread.
    pub fn of(pipe: impl Read + Send + 'static) -> std::io::Result<Captured> {
        let kept = Arc::<Mutex<Kept>>::default();
        let (tell, end) = channel();
        let own = Arc::clone(&kept);
        thread::Builder::new().name("script output".to_owned()).spawn(move || {
            read(pipe, &own);
            // Fails if the script was terminated and nothing waits for its output.
            let _ = tell.send(());
        })?;
        Ok(Captured { kept, end })
    }

    /// Waits for the end of the pipe. Returns whether it came in time.
    pub fn ends_within(&self, time: Duration) -> bool {
        self.end.recv_timeout(time) != Err(RecvTimeoutError::Timeout)
    }

    /// Returns the start of the output.
    pub fn first(&self) -> String {
        String::from_utf8_lossy(&lock(&self.kept).first).into_owned()
    }

    /// Returns the last `most` characters of the output.
    pub fn last(&self, most: usize) -> String {
        let bytes: Vec<u8> = lock(&self.kept).last.iter().copied().collect();
        let text = String::from_utf8_lossy(&bytes);
        let surplus = text.chars().count().saturating_sub(most);
        text.chars().skip(surplus).collect()
    }
}

fn lock(kept: &Mutex<Kept>) -> MutexGuard<'_, Kept> {
    kept.lock().unwrap_or_else(PoisonError::into_inner)
}

fn read(mut pipe: impl Read, kept: &Mutex<Kept>) {
    let mut buffer = [0; 1 << 14];
    loop {
        match pipe.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => lock(kept).add(&buffer[..count]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beginning_and_end_are_kept_of_however_much() {
        let text: String = (0..200_000).map(|number| format!("{number}\n")).collect();
        let captured = Captured::of(std::io::Cursor::new(text.clone())).expect("a thread");
        assert!(captured.ends_within(Duration::from_secs(10)));
        assert_eq!(captured.first(), text[..FIRST]);
        assert_eq!(captured.last(14), "199998\n199999\n");
        assert_eq!(captured.last(1 << 20).len(), LAST);
    }

    #[test]
    fn a_little_is_kept_whole() {
        let captured = Captured::of("one ü".as_bytes()).expect("a thread");
        assert!(captured.ends_within(Duration::from_secs(10)));
        assert_eq!((captured.first(), captured.last(1)), ("one ü".to_owned(), "ü".to_owned()));
    }
}
