//! Lines that a witness has not been told yet, beside the run they are of, so that no crash loses them.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Name of the file in a run's folder.
pub(super) const FILE: &str = "witness-queue.jsonl";
/// Bytes that are told at once.
const TOGETHER: u64 = 64 << 10;
/// Bytes kept in memory of lines that the disk refuses; a run whose disk refuses everything cannot be played anyway.
const MOST_IN_MEMORY: usize = 256 << 10;

/// Lines in the order in which they are to be told.
pub(super) struct Queue {
    path: PathBuf,
    /// Opened with the first line.
    file: Option<File>,
    /// Bytes of the file.
    length: u64,
    /// Bytes at its beginning that are told already.
    told: u64,
    /// Lines that the disk did not take.
    in_memory: Vec<u8>,
}

impl Queue {
    /// The queue in a run's folder, with what an earlier end of the program left in it.
    pub(super) fn of(run: &Path) -> Queue {
        let path = run.join(FILE);
        let mut queue = Queue { path, file: None, length: 0, told: 0, in_memory: Vec::new() };
        if let Ok(bytes) = std::fs::read(&queue.path) {
            // A line without its end was being written when the program ended; the trajectory has it.
            let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at as u64 + 1);
            if queue.open().is_ok_and(|file| file.set_len(whole).is_ok()) {
                queue.length = whole;
            }
        }
        queue
    }

    fn open(&mut self) -> io::Result<&mut File> {
        let file = match self.file.take() {
            Some(file) => file,
            None => File::options().read(true).append(true).create(true).open(&self.path)?,
        };
        Ok(self.file.insert(file))
    }

    /// Bytes that wait.
    pub(super) fn waiting(&self) -> u64 {
        self.length - self.told + self.in_memory.len() as u64
    }

    /// Takes a line. Not synced: after a power cut the trajectory still has it. While the disk refuses everything, only
    /// as many are kept as fit in memory.
    pub(super) fn push(&mut self, line: &str) {
        let before = self.in_memory.len();
        self.in_memory.extend_from_slice(line.as_bytes());
        self.settle();
        if self.in_memory.len() > MOST_IN_MEMORY {
            self.in_memory.truncate(before);
        }
    }

    /// Tries to put onto the disk what is only in memory.
    fn settle(&mut self) {
        let (bytes, length) = (std::mem::take(&mut self.in_memory), self.length);
        let written = self.open().and_then(|file| {
            file.write_all(&bytes).inspect_err(|_| {
                let _ = file.set_len(length);
            })
        });
        match written {
            Ok(()) => self.length += bytes.len() as u64,
            Err(_) => self.in_memory = bytes,
        }
    }

    /// The next whole lines to tell, if some wait.
    pub(super) fn next(&mut self) -> Option<Vec<u8>> {
        if self.told == self.length {
            return (!self.in_memory.is_empty()).then(|| self.in_memory.clone());
        }
        let (from, most) = (self.told, (self.length - self.told).min(TOGETHER));
        let mut bytes = Vec::new();
        let read = self.open().and_then(|file| {
            file.seek(SeekFrom::Start(from))?;
            file.take(most).read_to_end(&mut bytes)
        });
        let end = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        bytes.truncate(end);
        if read.is_err() || bytes.is_empty() {
            // The file was taken away; what it held is in the trajectory.
            (self.file, self.length, self.told) = (None, 0, 0);
            return (!self.in_memory.is_empty()).then(|| self.in_memory.clone());
        }
        Some(bytes)
    }

    /// Forgets as many bytes of what waits as were told.
    pub(super) fn forget(&mut self, bytes: usize) {
        if self.told == self.length {
            self.in_memory.drain(..bytes.min(self.in_memory.len()));
            return;
        }
        self.told = self.length.min(self.told + bytes as u64);
        if self.told == self.length && self.open().is_ok_and(|file| file.set_len(0).is_ok()) {
            (self.length, self.told) = (0, 0);
        }
    }

    /// Closes the file, and removes it if nothing waits.
    pub(super) fn close(&mut self) {
        self.file = None;
        if self.waiting() == 0 {
            // An empty file would say no more than none.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drain(queue: &mut Queue) -> String {
        let mut all = Vec::new();
        while let Some(bytes) = queue.next() {
            assert!(bytes.ends_with(b"\n") && bytes.len() as u64 <= TOGETHER.max(MOST_IN_MEMORY as u64));
            queue.forget(bytes.len());
            all.extend(bytes);
        }
        String::from_utf8(all).expect("text")
    }

    #[test]
    fn lines_come_in_order_and_outlive_the_program() {
        let run = tempfile::tempdir().expect("a folder");
        let lines: Vec<String> = (0..5_000).map(|number| format!("line {number:05} of a run\n")).collect();
        let mut queue = Queue::of(run.path());
        assert_eq!(queue.next(), None);
        lines.iter().for_each(|line| queue.push(line));
        drop(queue);
        let path = run.path().join(FILE);
        let mut torn = std::fs::read(&path).expect("a file");
        torn.extend_from_slice(b"line 0500");
        std::fs::write(&path, torn).expect("written");
        let mut queue = Queue::of(run.path());
        let first = queue.next().expect("lines");
        queue.forget(first.len());
        queue.push("and one more\n");
        let rest = drain(&mut queue);
        assert_eq!(String::from_utf8(first).expect("text") + &rest, lines.concat() + "and one more\n");
        queue.close();
        assert!(!path.exists());
    }

    #[test]
    fn while_the_disk_refuses_memory_is_bounded_and_then_everything_goes_there() {
        let place = tempfile::tempdir().expect("a folder");
        let run = place.path().join("missing");
        let mut queue = Queue::of(&run);
        (0..20_000).for_each(|number| queue.push(&format!("line {number:05} of a run\n")));
        let kept = queue.waiting();
        assert!(kept > 0 && kept <= MOST_IN_MEMORY as u64);
        let first = queue.next().expect("lines");
        std::fs::create_dir(&run).expect("room again");
        // What is being told goes to the disk meanwhile, and is still told once.
        queue.push("the last\n");
        queue.forget(first.len());
        assert_eq!(drain(&mut queue), "the last\n");
        assert_eq!(first.len() as u64, kept);
        assert!(first.starts_with(b"line 00000 ") && first.ends_with(b" of a run\n"), "whole lines");
    }

    #[test]
    fn a_queue_that_was_removed_goes_on_with_what_comes() {
        let run = tempfile::tempdir().expect("a folder");
        let mut queue = Queue::of(run.path());
        queue.push("one\n");
        File::options().write(true).open(run.path().join(FILE)).expect("a file").set_len(0).expect("cut");
        assert_eq!(queue.next(), None);
        queue.push("two\n");
        assert_eq!(drain(&mut queue), "two\n");
    }
}
