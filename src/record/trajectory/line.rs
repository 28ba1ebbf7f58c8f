//! Lines of a trajectory. A line consists of frame fields, an event and a checksum.

use std::borrow::Cow;
use std::io::{BufRead, BufReader};
use std::path::Path;

use serde::Deserialize;
use serde_json::{Map, Value};

use super::record::Record;
use crate::clock::{parse_nanoseconds, parse_seconds};
use crate::files::open_regular_file;
use crate::trajectory::CHAIN_BROKEN_MESSAGE;
use novamind_database::ProjectionPosition;

/// A parsed line of a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Number of the line in the trajectory, from 0.
    pub seq: u64,
    /// Day of the run on which the line was written.
    pub day: u32,
    /// Time at which the line was written, RFC 3339.
    pub at: String,
    /// Event that the line records.
    pub record: Record,
    /// BLAKE3 hash of the line's bytes, in hexadecimal digits.
    pub hash: String,
    /// Bytes of the line in the file.
    text: Box<[u8]>,
}

/// Frame fields, which every line has.
#[derive(Deserialize)]
struct Frame<'a> {
    seq: Option<u64>,
    #[serde(borrow)]
    kind: Option<Cow<'a, str>>,
    day: Option<u32>,
    at: Option<String>,
    #[serde(borrow)]
    prev: Option<Cow<'a, str>>,
    #[serde(default)]
    line_sums: bool,
}

const FRAME_FIELDS: [&str; 6] = ["seq", "kind", "day", "at", "prev", "sum"];

impl Line {
    /// Parses and checks a line. Lines of the first builds have no checksums. The first line of a run declares whether
    /// its lines have checksums.
    pub(super) fn parse(text: &[u8], seq: u64, previous: &str, summed: bool) -> Result<Line, String> {
        let unreadable = |error: serde_json::Error| format!("this is not a line of a trajectory ({error})");
        let frame: Frame<'_> = serde_json::from_slice(text).map_err(unreadable)?;
        let summed = summed && (seq > 0 || frame.line_sums);
        if verify_checksum(text).map_or(summed, |fits| !fits) {
            return Err("the line does not match its checksum: it was changed".to_owned());
        }
        if frame.seq != Some(seq) {
            return Err(format!("the line should have number {seq}: lines are missing or out of order"));
        }
        if frame.prev.as_deref() != Some(previous) {
            return Err(CHAIN_BROKEN_MESSAGE.to_owned());
        }
        let (Some(kind), Some(at), Some(day)) = (frame.kind, frame.at, frame.day) else {
            return Err("the line has no kind, time or day".to_owned());
        };
        let record = Record::parse(&kind, text)
            .map_err(|error| format!("the {kind} line cannot be read ({error})"))?;
        Ok(Line { seq, day, at, record, hash: line_hash(text), text: text.into() })
    }

    /// Parses the first line of a file. Returns `None` if the line is invalid.
    pub fn parse_first(text: &[u8]) -> Option<Line> {
        Line::parse(text, 0, &line_hash(b""), true).ok()
    }

    /// Parses a line without checking its position and checksum. Returns `None` if the line cannot be parsed.
    pub fn parse_unchecked(text: &[u8]) -> Option<Line> {
        let frame: Frame<'_> = serde_json::from_slice(text).ok()?;
        let (seq, day, at) = (frame.seq.unwrap_or(0), frame.day?, frame.at.unwrap_or_default());
        let record = Record::parse(&frame.kind?, text).ok()?;
        Some(Line { seq, day, at, record, hash: line_hash(text), text: text.into() })
    }

    /// Returns the number and the hash of the line.
    pub fn position(&self) -> ProjectionPosition {
        ProjectionPosition { seq: self.seq, line_hash: self.hash.clone() }
    }

    /// Returns whether the line closes simulated days: a week, or single days of a debug run.
    pub fn closes_days(&self) -> bool {
        self.record.closed_days().is_some()
    }

    /// Returns whether this first line declares that every line of the run has a checksum.
    pub fn declares_checksums(&self) -> bool {
        matches!(&self.record, Record::Start(start) if start.line_sums)
    }

    /// Returns the time of the line in seconds since the Unix epoch, or 0 if its timestamp is invalid.
    pub fn at_seconds(&self) -> f64 {
        parse_seconds(&self.at)
    }

    /// Returns the time of the line in nanoseconds since the Unix epoch, or 0 if its timestamp is invalid.
    pub fn at_nanoseconds(&self) -> i64 {
        parse_nanoseconds(&self.at)
    }

    /// Returns the fields of the event, including fields that this version does not define.
    pub fn record_fields(&self) -> Map<String, Value> {
        let mut fields: Map<String, Value> = serde_json::from_slice(&self.text).unwrap_or_default();
        fields.retain(|name, _| !FRAME_FIELDS.contains(&name.as_str()));
        fields
    }

    /// Returns a line that is not in a file, for tests.
    #[cfg(any(test, feature = "test-kit"))]
    pub fn detached(seq: u64, day: u32, at: &str, record: Record) -> Line {
        let text = Value::Object(record.fields()).to_string().into_bytes();
        Line { seq, day, at: at.to_owned(), record, hash: line_hash(&text), text: text.into() }
    }
}

/// Returns the hash of a line's bytes, in hexadecimal digits.
pub(super) fn line_hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// Returns the hash of the first line of a file, or `None` if the file cannot be read or has no complete line.
pub fn first_line_hash(path: &Path) -> Option<String> {
    let mut line = Vec::new();
    BufReader::new(open_regular_file(path).ok()?).read_until(b'\n', &mut line).ok()?;
    line.pop_if(|last| *last == b'\n').map(|_| line_hash(&line))
}

const CHECKSUM_PREFIX: &[u8] = b",\"sum\":\"";
const CHECKSUM_DIGITS: usize = 16;

/// Appends the field `sum` to a line: the checksum of all other bytes.
pub(super) fn with_checksum(mut line: Vec<u8>) -> Vec<u8> {
    let sum = line_hash(&line);
    line.pop();
    line.extend_from_slice(CHECKSUM_PREFIX);
    line.extend_from_slice(&sum.as_bytes()[..CHECKSUM_DIGITS]);
    line.extend_from_slice(b"\"}");
    line
}

/// Returns whether the checksum of a line is correct, or `None` if the line has no checksum.
fn verify_checksum(line: &[u8]) -> Option<bool> {
    let (bytes, tail) =
        line.split_at_checked(line.len().checked_sub(CHECKSUM_PREFIX.len() + CHECKSUM_DIGITS + 2)?)?;
    let sum = tail.strip_prefix(CHECKSUM_PREFIX)?.strip_suffix(b"\"}")?;
    let without: Vec<u8> = bytes.iter().copied().chain([b'}']).collect();
    Some(line_hash(&without).as_bytes().starts_with(sum))
}
