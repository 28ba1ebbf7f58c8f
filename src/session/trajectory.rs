//! `trajectory.jsonl`: the truth of a run, one line per action (chapter 70 §5, format 1).
//!
//! Lines are appended and never changed. Each names the hash of the one before and ends with a sum of its own, so
//! what is cut, flipped or inserted shows, in the last line too. A line whose last byte is missing was never
//! confirmed and is dropped.

use std::fs::File;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value};
use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;

use super::error::RunError;
use super::medium::Medium;
use crate::database::Position;

/// When a line has to be on the disk (chapter 90 §4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Durability {
    /// Before anything is confirmed.
    Synced,
    /// With the next synced line.
    Written,
}

/// A line that was read back.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Number, from 0.
    pub seq: u64,
    /// Kind, for instance `call`.
    pub kind: String,
    /// Day of the run.
    pub day: u32,
    /// When it was written, RFC 3339.
    pub at: String,
    /// All fields.
    pub fields: Map<String, Value>,
    /// Hash of the line.
    pub hash: String,
}

impl Line {
    /// Number and hash.
    pub fn position(&self) -> Position {
        Position { seq: self.seq, line_hash: self.hash.clone() }
    }

    /// Whether it closes days that ran: a week, or single steps.
    pub fn closes_days(&self) -> bool {
        matches!(self.kind.as_str(), "week" | "step")
    }

    /// Whether it is a call of a tool that was accepted.
    pub fn is_accepted_call(&self) -> bool {
        self.kind == "call" && self.fields.get("ok") == Some(&Value::Bool(true))
    }

    /// When it was written, seconds since 1970; 0 if that cannot be read.
    pub fn moment(&self) -> f64 {
        seconds(&self.at)
    }
}

/// Hash of a line's bytes, in hexadecimal digits.
fn line_hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// Field of the first line that says that every line ends with a sum.
pub const SUMS: &str = "line_sums";
/// What stands before the sum of a line.
const SUM: &[u8] = b",\"sum\":\"";
/// Hexadecimal digits of a sum.
const SUM_DIGITS: usize = 16;

/// A line with the sum of its own bytes as its last field.
fn with_sum(mut line: Vec<u8>) -> Vec<u8> {
    let sum = line_hash(&line);
    line.pop();
    line.extend_from_slice(SUM);
    line.extend_from_slice(&sum.as_bytes()[..SUM_DIGITS]);
    line.extend_from_slice(b"\"}");
    line
}

/// Whether a line ends with a sum, and with the right one.
fn sum_of(line: &[u8]) -> Option<bool> {
    let (own, tail) = line.split_at_checked(line.len().checked_sub(SUM.len() + SUM_DIGITS + 2)?)?;
    let sum = tail.strip_prefix(SUM)?.strip_suffix(b"\"}")?;
    let without: Vec<u8> = own.iter().copied().chain([b'}']).collect();
    Some(line_hash(&without).as_bytes().starts_with(sum))
}

/// The present moment, RFC 3339.
pub fn now() -> String {
    OffsetDateTime::now_utc().format(&Rfc3339).unwrap_or_default()
}

/// Seconds since 1970 of a moment of a line.
pub fn seconds(at: &str) -> f64 {
    OffsetDateTime::parse(at, &Rfc3339).map_or(0.0, |moment| moment.unix_timestamp_nanos() as f64 / 1e9)
}

/// Appends lines.
pub struct TrajectoryWriter {
    /// The file; none for a run in memory.
    medium: Option<Box<dyn Medium>>,
    path: PathBuf,
    /// Bytes of the file that are good.
    length: u64,
    /// Lines that could not be written yet, in order, and must come first.
    backlog: Vec<u8>,
    next_seq: u64,
    last_hash: String,
}

impl TrajectoryWriter {
    /// A trajectory in memory: only numbers and hashes are kept.
    pub fn in_memory() -> TrajectoryWriter {
        TrajectoryWriter {
            medium: None,
            path: PathBuf::new(),
            length: 0,
            backlog: Vec::new(),
            next_seq: 0,
            last_hash: line_hash(b""),
        }
    }

    /// A new file.
    ///
    /// # Errors
    /// It exists already, or cannot be made.
    pub fn create(path: &Path) -> Result<TrajectoryWriter, RunError> {
        let file = File::options().create_new(true).append(true).open(path).map_err(RunError::io(path))?;
        let medium: Box<dyn Medium> = Box::new(file);
        Ok(TrajectoryWriter { medium: Some(medium), path: path.to_owned(), ..TrajectoryWriter::in_memory() })
    }

    /// Goes on with a file that was read; bytes after the good ones are cut off.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn resume(path: &Path, read: &Trajectory) -> Result<TrajectoryWriter, RunError> {
        let mut file = File::options().write(true).open(path).map_err(RunError::io(path))?;
        file.cut(read.length).map_err(RunError::io(path))?;
        Ok(TrajectoryWriter {
            medium: Some(Box::new(file)),
            path: path.to_owned(),
            length: read.length,
            backlog: Vec::new(),
            next_seq: read.lines.len() as u64,
            last_hash: read.lines.last().map_or_else(|| line_hash(b""), |line| line.hash.clone()),
        })
    }

    /// Number and hash of the last line.
    pub fn position(&self) -> Position {
        Position { seq: self.next_seq.saturating_sub(1), line_hash: self.last_hash.clone() }
    }

    /// Appends a line and returns the moment it carries.
    ///
    /// # Errors
    /// The disk refuses: then the line does not exist, and the file is as it was.
    pub fn append(
        &mut self,
        kind: &str,
        day: u32,
        fields: Map<String, Value>,
        durability: Durability,
    ) -> Result<String, RunError> {
        let (bytes, hash, at) = self.line(kind, day, fields);
        let written = self.write(&bytes, durability);
        if written.is_ok() {
            self.accept(hash);
        }
        written.map(|()| at)
    }

    /// Appends a line about something that cannot be taken back. If the disk refuses, the line waits in memory
    /// and goes first with the next one.
    ///
    /// # Errors
    /// The disk refuses for now.
    pub fn append_done(&mut self, kind: &str, day: u32, fields: Map<String, Value>) -> Result<(), RunError> {
        let (bytes, hash, _) = self.line(kind, day, fields);
        let written = self.write(&bytes, Durability::Synced);
        if written.is_err() {
            self.backlog.extend_from_slice(&bytes);
        }
        self.accept(hash);
        written
    }

    fn accept(&mut self, hash: String) {
        self.next_seq += 1;
        self.last_hash = hash;
    }

    fn line(&self, kind: &str, day: u32, fields: Map<String, Value>) -> (Vec<u8>, String, String) {
        let at = now();
        let mut line = Map::new();
        line.insert("seq".to_owned(), self.next_seq.into());
        line.insert("kind".to_owned(), kind.into());
        line.insert("day".to_owned(), day.into());
        line.insert("at".to_owned(), at.clone().into());
        line.insert("prev".to_owned(), self.last_hash.clone().into());
        debug_assert!(
            fields.keys().all(|name| !line.contains_key(name)),
            "a field hides a part of the frame: {kind}"
        );
        line.extend(fields);
        let mut bytes = with_sum(Value::Object(line).to_string().into_bytes());
        let hash = line_hash(&bytes);
        bytes.push(b'\n');
        (bytes, hash, at)
    }

    fn write(&mut self, bytes: &[u8], durability: Durability) -> Result<(), RunError> {
        let Some(medium) = &mut self.medium else { return Ok(()) };
        if !medium.is_ours(&self.path, self.length) {
            // Lines of another program are not overwritten, and nothing is told to be saved that nobody finds.
            return Err(RunError::Astray { path: self.path.clone() });
        }
        let mut all = self.backlog.clone();
        all.extend_from_slice(bytes);
        let written = medium.append(&all).and_then(|()| match durability {
            Durability::Synced => medium.sync(),
            Durability::Written => Ok(()),
        });
        match written {
            Ok(()) => {
                self.length += all.len() as u64;
                self.backlog.clear();
                Ok(())
            }
            Err(error) => {
                // Whatever got through is no line yet; the file ends where it ended.
                let _ = medium.cut(self.length);
                Err(RunError::Io { path: self.path.clone(), error })
            }
        }
    }

    /// Puts the lines that were written on the disk, whatever still waits in memory.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn sync_written(&self) -> Result<(), RunError> {
        self.medium.as_ref().map_or(Ok(()), |medium| medium.sync()).map_err(RunError::io(&self.path))
    }

    /// Whether the file still stands where it is looked for, and no line waits for it.
    pub fn is_complete(&self) -> bool {
        let is_ours = self.medium.as_ref().is_none_or(|medium| medium.is_ours(&self.path, self.length));
        is_ours && self.backlog.is_empty()
    }

    /// Puts another medium in place of the file.
    #[cfg(test)]
    pub(super) fn write_to(&mut self, medium: Box<dyn Medium>) {
        self.medium = Some(medium);
    }

    /// Puts everything on the disk.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn sync(&mut self) -> Result<(), RunError> {
        self.write(b"", Durability::Synced)
    }
}

/// A trajectory that was read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trajectory {
    /// Its lines.
    pub lines: Vec<Line>,
    /// Bytes of the file that hold them.
    pub length: u64,
    /// Bytes after the last complete line: a line that was never confirmed.
    pub unfinished: usize,
}

impl Trajectory {
    /// Reads and checks a file: every line is JSON, numbered, and names the hash of the one before.
    ///
    /// # Errors
    /// The file cannot be read, or a line is damaged; the error names it and says what is still good.
    pub fn read(path: &Path) -> Result<Trajectory, RunError> {
        Trajectory::of_file(path, &std::fs::read(path).map_err(RunError::io(path))?)
    }

    /// Checks the bytes of a file as [`Trajectory::read`] does.
    ///
    /// # Errors
    /// A line is damaged; the error names it and says what is still good.
    pub fn of_file(path: &Path, bytes: &[u8]) -> Result<Trajectory, RunError> {
        Trajectory::parse(bytes).map_err(damaged_at(path))
    }

    /// Checks bytes as [`Trajectory::read`] does.
    ///
    /// # Errors
    /// (line, problem), lines from 1.
    pub fn parse(bytes: &[u8]) -> Result<Trajectory, (usize, String)> {
        let mut trajectory = Trajectory::default();
        trajectory.extend(bytes).map(|()| trajectory)
    }

    /// Takes what follows in the file after the lines that are known.
    ///
    /// # Errors
    /// (line, problem), lines from 1. The lines before it are kept.
    pub fn extend(&mut self, bytes: &[u8]) -> Result<(), (usize, String)> {
        let end = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        for text in bytes[..end].split_inclusive(|byte| *byte == b'\n') {
            let line = &text[..text.len() - 1];
            let expected = self.lines.last().map_or_else(|| line_hash(b""), |line| line.hash.clone());
            let number = self.lines.len() + 1;
            let summed = self.lines.first().is_none_or(|first| first.fields.get(SUMS) == Some(&true.into()));
            let line = parse_line(line, self.lines.len() as u64, &expected, summed)
                .map_err(|problem| (number, problem))?;
            self.lines.push(line);
            self.length += text.len() as u64;
        }
        self.unfinished = bytes.len() - end;
        Ok(())
    }
}

/// A line of a file that is not what was written, as an error.
pub(super) fn damaged_at(path: &Path) -> impl Fn((usize, String)) -> RunError + '_ {
    move |(line, problem)| RunError::Damaged {
        path: path.to_owned(),
        line,
        safe: match line.saturating_sub(if problem == DOES_NOT_FOLLOW { 2 } else { 1 }) {
            0 => "Nothing before it can be used".to_owned(),
            good => format!("Lines 1 to {good} are good; nothing was changed{BRANCH_THEM}"),
        },
        problem,
    }
}

/// Each of two lines fits its own sum, and they contradict each other.
pub(super) const DOES_NOT_FOLLOW: &str =
    "the line does not follow from the one before: one of the two was changed";

/// What can be done with the lines before a damaged one.
pub(super) const BRANCH_THEM: &str = ": `novamind runs rescue` makes a branch of them";

/// Reads a line. Those of the first builds have no sums; of a first line only it itself tells whether it has one.
fn parse_line(text: &[u8], seq: u64, previous: &str, summed: bool) -> Result<Line, String> {
    let fields: Map<String, Value> =
        serde_json::from_slice(text).map_err(|error| format!("this is no line of a trajectory ({error})"))?;
    let summed = summed && (seq > 0 || fields.get(SUMS) == Some(&true.into()));
    if sum_of(text).map_or(summed, |fits| !fits) {
        return Err("the line does not fit its own sum: it was changed".to_owned());
    }
    if fields.get("seq").and_then(Value::as_u64) != Some(seq) {
        return Err(format!("the line should have number {seq}: lines are missing or out of order"));
    }
    if fields.get("prev").and_then(Value::as_str) != Some(previous) {
        return Err(DOES_NOT_FOLLOW.to_owned());
    }
    let word = |name: &str| fields.get(name).and_then(Value::as_str).map(str::to_owned);
    let day = fields.get("day").and_then(Value::as_u64).and_then(|day| u32::try_from(day).ok());
    match (word("kind"), word("at"), day) {
        (Some(kind), Some(at), Some(day)) => Ok(Line { seq, kind, day, at, hash: line_hash(text), fields }),
        _ => Err("the line lacks its kind, its moment or its day".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn fields(value: Value) -> Map<String, Value> {
        value.as_object().cloned().unwrap_or_default()
    }

    fn written(folder: &Path, count: u64) -> PathBuf {
        let path = folder.join("trajectory.jsonl");
        let mut writer = TrajectoryWriter::create(&path).expect("a file");
        for number in 0..count {
            let line =
                fields(json!({"tool": "set_prices", "number": number, "text": "größer", (SUMS): true}));
            writer.append("call", number as u32, line, Durability::Synced).expect("a line");
        }
        path
    }

    #[test]
    fn lines_come_back_and_can_be_continued() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = written(folder.path(), 3);
        let read = Trajectory::read(&path).expect("it reads");
        assert_eq!(read.lines.len(), 3);
        assert_eq!(read.lines[2].fields["number"], 2);
        let mut writer = TrajectoryWriter::resume(&path, &read).expect("it opens");
        assert_eq!(writer.position(), read.lines[2].position());
        writer.append("memo", 9, Map::new(), Durability::Written).expect("a line");
        assert_eq!(Trajectory::read(&path).expect("it reads").lines[3].kind, "memo");
        assert!(TrajectoryWriter::create(&path).is_err());
    }

    #[test]
    fn an_unfinished_line_is_dropped() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = written(folder.path(), 3);
        let bytes = std::fs::read(&path).expect("bytes");
        std::fs::write(&path, &bytes[..bytes.len() - 5]).expect("a cut");
        let read = Trajectory::read(&path).expect("it reads");
        assert_eq!(read.lines.len(), 2);
        assert!(read.unfinished > 0);
        let mut writer = TrajectoryWriter::resume(&path, &read).expect("it opens");
        writer.append("call", 2, Map::new(), Durability::Synced).expect("a line");
        assert_eq!(Trajectory::read(&path).expect("it reads").lines.len(), 3);
    }

    #[test]
    fn a_file_that_is_gone_or_grew_elsewhere_takes_no_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = written(folder.path(), 3);
        let read = Trajectory::read(&path).expect("it reads");
        let [mut first, mut second] =
            [(), ()].map(|()| TrajectoryWriter::resume(&path, &read).expect("it opens"));
        let note = |writer: &mut TrajectoryWriter| writer.append("memo", 9, Map::new(), Durability::Synced);
        note(&mut second).expect("a line");
        let kept = std::fs::read(&path).expect("bytes");
        assert!(matches!(note(&mut first), Err(RunError::Astray { .. })), "somebody else has written");
        assert_eq!(std::fs::read(&path).expect("bytes"), kept, "and keeps the line");
        std::fs::rename(&path, folder.path().join("aside")).expect("moved");
        assert!(matches!(note(&mut second), Err(RunError::Astray { .. })), "it was moved");
        std::fs::copy(folder.path().join("aside"), &path).expect("a copy");
        assert!(matches!(note(&mut second), Err(RunError::Astray { .. })), "a copy is another file");
        std::fs::remove_file(&path).expect("removed");
        std::fs::rename(folder.path().join("aside"), &path).expect("moved back");
        note(&mut second).expect("it is there again");
    }

    #[test]
    fn every_flipped_byte_and_every_missing_line_is_found() {
        let folder = tempfile::tempdir().expect("a folder");
        let bytes = std::fs::read(written(folder.path(), 4)).expect("bytes");
        let whole = Trajectory::parse(&bytes).expect("it reads");
        // Without its line end the last line counts as unfinished.
        for at in 0..bytes.len() - 1 {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x04;
            assert!(Trajectory::parse(&damaged).is_err(), "byte {at} was changed unseen");
        }
        let mut lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
        lines.remove(1);
        assert_eq!(Trajectory::parse(&lines.concat()).expect_err("a line is missing").0, 2);
        lines.swap(0, 1);
        assert_eq!(Trajectory::parse(&lines.concat()).expect_err("out of order").0, 1);
        assert_eq!(whole.unfinished, 0);
        assert_eq!(Trajectory::parse(b"").expect("an empty file").lines.len(), 0);
    }
}
