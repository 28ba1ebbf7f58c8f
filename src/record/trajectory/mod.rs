//! The trajectory of a run, `trajectory.jsonl`: one line per event (docs/formats/trajectory.md).
//!
//! Lines are appended and never changed. Each line has the hash of the previous line and ends with a checksum of the
//! line. The checksum reveals truncated, changed and inserted bytes. A last line without a line feed was never
//! confirmed and is dropped.

mod line;
mod medium;
#[cfg(any(test, feature = "test-kit"))]
mod page_cache;
pub mod record;
mod synced_file;
mod writer;

use std::path::Path;

pub use line::Line;
pub use line::first_line_hash;
#[cfg(any(test, feature = "test-kit"))]
pub use medium::Medium;
#[cfg(any(test, feature = "test-kit"))]
pub use page_cache::PageCache;
pub use record::Record;
pub use writer::{Durability, TrajectoryWriter};

use crate::error::RunError;
use crate::files::read_regular_file;
use line::line_hash;
use novamind_database::ProjectionPosition;
use record::Via;

/// Prefix of the rationale of a week that a policy decided; the name of the policy follows.
const POLICY_RATIONALE_PREFIX: &str = "policy ";

/// Returns the last `end` line, or `None` if the run is unfinished.
pub fn find_end(lines: &[Line]) -> Option<&Line> {
    lines.iter().rev().find(|line| matches!(line.record, Record::End(_)))
}

/// Returns the rationale for a week that a policy decides.
pub fn policy_rationale(name: &str) -> String {
    format!("{POLICY_RATIONALE_PREFIX}{name}")
}

/// Returns the name of the policy that decided all weeks in `lines`, according to their rationales. Returns `None` if
/// there are no weeks, or if a week was not decided by this policy.
pub fn find_policy(lines: &[Line]) -> Option<&str> {
    let mut weeks = lines.iter().filter_map(|line| match &line.record {
        Record::Advance(week) => Some(week),
        _ => None,
    });
    let first = weeks.next()?;
    let is_one = first.via == Via::Policy
        && weeks.all(|week| week.via == Via::Policy && week.rationale == first.rationale);
    first.rationale.strip_prefix(POLICY_RATIONALE_PREFIX).filter(|_| is_one)
}

/// A parsed trajectory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trajectory {
    /// Lines, in the order of the file.
    pub lines: Vec<Line>,
    /// Total length of the complete lines in the file, in bytes.
    pub length: u64,
    /// Number of bytes after the last complete line, which were never confirmed.
    pub unfinished_bytes: usize,
    /// Position of the last line of the previous file, if this file continues another file.
    continued_position: Option<ProjectionPosition>,
}

impl Trajectory {
    /// Reads a trajectory file and checks that every line is valid JSON, has the correct number, and has the hash of
    /// the previous line.
    ///
    /// # Errors
    /// The file cannot be read, or a line is damaged; the error names the line and the valid lines before it.
    pub fn read(path: &Path) -> Result<Trajectory, RunError> {
        Trajectory::from_bytes(path, &read_regular_file(path).map_err(RunError::io(path))?)
    }

    /// Returns the last `end` line, or `None` if the run is unfinished. In format 1, other lines can follow the `end`
    /// line.
    pub fn end_line(&self) -> Option<&Line> {
        find_end(&self.lines)
    }

    /// Parses and checks the bytes of a trajectory file. Converts errors of [`Trajectory::parse`] to [`RunError`].
    ///
    /// # Errors
    /// A line is damaged; the error names the line and the valid lines before it.
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Trajectory, RunError> {
        Trajectory::parse(bytes).map_err(damaged_line_error(path))
    }

    /// Parses and checks the bytes of a trajectory.
    ///
    /// # Errors
    /// A line is damaged; returns the line number, from 1, and the problem.
    pub fn parse(bytes: &[u8]) -> Result<Trajectory, (usize, String)> {
        let mut trajectory = Trajectory::default();
        trajectory.append_bytes(bytes).map(|()| trajectory)
    }

    /// Parses and checks the bytes of a file that continues another file after the line `last`.
    ///
    /// # Errors
    /// A line is damaged; the error names the line and the valid lines before it.
    pub fn from_bytes_after(
        path: &Path,
        last: ProjectionPosition,
        bytes: &[u8],
    ) -> Result<Trajectory, RunError> {
        let mut trajectory = Trajectory { continued_position: Some(last), ..Trajectory::default() };
        trajectory.append_bytes(bytes).map_err(damaged_line_error(path))?;
        Ok(trajectory)
    }

    /// Returns the number that the next appended line must have.
    pub fn next_seq(&self) -> u64 {
        self.continued_position.as_ref().map_or(0, |last| last.seq + 1) + self.lines.len() as u64
    }

    /// Returns the hash that the next line must have as `prev`.
    pub fn last_hash(&self) -> String {
        let before =
            || self.continued_position.as_ref().map_or_else(|| line_hash(b""), |last| last.line_hash.clone());
        self.lines.last().map_or_else(before, |line| line.hash.clone())
    }

    /// Returns whether every line must have a checksum; true before the first line.
    fn has_checksums(&self) -> bool {
        self.continued_position.is_some() || self.lines.first().is_none_or(Line::declares_checksums)
    }

    /// Parses and checks bytes that follow the parsed bytes in the file.
    ///
    /// # Errors
    /// A line is damaged; returns the line number, from 1, and the problem. The lines before the damaged line are kept.
    pub fn append_bytes(&mut self, bytes: &[u8]) -> Result<(), (usize, String)> {
        let end = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        for text in bytes[..end].split_inclusive(|byte| *byte == b'\n') {
            let line = &text[..text.len() - 1];
            let number = self.lines.len() + 1;
            let line = Line::parse(line, self.next_seq(), &self.last_hash(), self.has_checksums())
                .map_err(|problem| (number, problem))?;
            self.lines.push(line);
            self.length += text.len() as u64;
        }
        self.unfinished_bytes = bytes.len() - end;
        Ok(())
    }
}

/// Returns a function that converts the number and problem of a damaged line to an error.
pub fn damaged_line_error(path: &Path) -> impl Fn((usize, String)) -> RunError + '_ {
    move |(line, problem)| RunError::Damaged {
        path: path.to_owned(),
        line,
        remedy: match line.saturating_sub(if problem == CHAIN_BROKEN_MESSAGE { 2 } else { 1 }) {
            0 => "There are no valid lines before it".to_owned(),
            good => format!("Lines 1 to {good} are valid; nothing was changed{RECOVERY_HINT}"),
        },
        problem,
    }
}

/// Message for a line with a correct checksum whose `prev` field is not the hash of the previous line.
pub const CHAIN_BROKEN_MESSAGE: &str =
    "the line does not have the hash of the previous line: one of these two lines was changed";

/// Hint to recover the lines before a damaged line.
pub const RECOVERY_HINT: &str = ": `novamind runs recover` creates a branch from them";

#[cfg(test)]
mod tests {
    use super::*;

    use serde_json::{Value, json};

    fn schema_examples() -> Vec<(String, Value)> {
        let schema: Value =
            serde_json::from_str(include_str!("../../../assets/trajectory.schema.json")).expect("JSON");
        let kinds = schema["$defs"].as_object().expect("definitions");
        let examples =
            kinds.iter().filter_map(|(kind, value)| Some((kind, value.get("examples")?.as_array()?)));
        examples.flat_map(|(kind, all)| all.iter().map(|one| (kind.clone(), one.clone()))).collect()
    }

    #[test]
    fn every_kind_round_trips_its_schema_example() {
        let examples = schema_examples();
        for (kind, example) in &examples {
            let text = example.to_string();
            let record = Record::parse(kind, text.as_bytes()).expect(kind);
            assert_eq!(record.kind(), kind);
            let fields = example.as_object().expect("an object").iter();
            let record_fields = fields
                .filter(|(name, _)| !["seq", "kind", "day", "at", "prev", "sum"].contains(&name.as_str()));
            let record_fields: serde_json::Map<String, Value> =
                record_fields.map(|(name, value)| (name.clone(), value.clone())).collect();
            assert_eq!(Value::Object(record.fields()).to_string(), Value::Object(record_fields).to_string());
        }
        let kinds: std::collections::BTreeSet<&str> =
            examples.iter().map(|(kind, _)| kind.as_str()).collect();
        assert_eq!(kinds.len(), 25, "{kinds:?}");
    }

    #[test]
    fn record_parse_rejects_missing_fields_and_keeps_unknown_fields() {
        for (kind, example) in schema_examples() {
            let (seq, previous) =
                (example["seq"].as_u64().expect("a number"), example["prev"].as_str().expect("a hash"));
            let read = |fields: &Value| Line::parse(fields.to_string().as_bytes(), seq, previous, false);
            let mut without_sum = example.clone();
            let fields = without_sum.as_object_mut().expect("an object");
            fields.remove("sum");
            fields.insert("later".to_owned(), json!([1, "two"]));
            assert_eq!(read(&without_sum).expect(&kind).record_fields()["later"], json!([1, "two"]));
            let needed = match kind.as_str() {
                "start" => "seed",
                "call" => "tool",
                "query" => "sql",
                "view" => "screen",
                "memo" | "note" => "digest",
                "session" | "clock" => "event",
                "limit" => "used_ms",
                "select" => "which",
                "dialog" => "outcome",
                "help" => "term",
                "draft" => "typed",
                "question" => "form",
                "answer" => "id",
                "lesson" => "step",
                "look" => "command",
                "xray" => "shown_day",
                "voice" => "what",
                "advance" => "rationale",
                "week" | "step" => "days_run",
                "override" => "key",
                "branch" => "from",
                _ => "reason",
            };
            without_sum.as_object_mut().expect("an object").remove(needed);
            let problem = read(&without_sum).expect_err("a field is missing");
            assert!(problem.contains(&format!("missing field `{needed}`")), "{problem}");
        }
    }

    #[test]
    fn recorded_lines_serialize_to_the_same_bytes() {
        let recorded = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/recorded");
        let mut count = 0;
        for folder in std::fs::read_dir(recorded).expect("a folder").flatten() {
            if !folder.file_name().to_string_lossy().starts_with("format2-") {
                continue;
            }
            let path = folder.path().join("trajectory.jsonl");
            let text = std::fs::read_to_string(&path).expect("a trajectory");
            let lines = Trajectory::read(&path).expect("it reads").lines;
            for (line, text) in lines.iter().zip(text.lines()) {
                let fields = Value::Object(line.record.fields()).to_string();
                let line_fields = Value::Object(line.record_fields()).to_string();
                assert_eq!(fields, line_fields, "{}: line {}", path.display(), line.seq + 1);
                assert!(
                    text.contains(&line_fields[1..line_fields.len() - 1]),
                    "{}: line {}",
                    path.display(),
                    line.seq + 1
                );
                count += 1;
            }
        }
        assert!(count > 400, "{count}");
    }
}
