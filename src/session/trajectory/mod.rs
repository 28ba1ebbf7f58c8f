//! `trajectory.jsonl`: the truth of a run, one line per action (docs/formats/trajectory.md).
//!
//! Lines are appended and never changed. Each names the hash of the one before and ends with a sum of its own, so
//! what is cut, flipped or inserted shows, in the last line too. A line whose last byte is missing was never
//! confirmed and is dropped.

#[cfg(test)]
mod failed_sync_tests;
mod line;
mod medium;
#[cfg(test)]
mod page_cache;
mod policy;
pub mod record;
mod regular_file;
mod synced_file;
mod time;
mod writer;

use std::path::Path;

pub use line::Line;
pub(super) use line::hash_of_first_line;
#[cfg(test)]
pub(super) use medium::Medium;
#[cfg(test)]
pub(super) use page_cache::PageCache;
pub use policy::{policy_of, policy_rationale};
pub use record::Record;
pub(super) use regular_file::{
    append_to_regular_file, open_regular_file, read_regular_file, read_regular_text,
};
pub(super) use time::scripted_steady;
pub use time::{ScriptedClock, nanoseconds, now, seconds, steady, written_moment};
pub use writer::{Durability, TrajectoryWriter};

use crate::database::Position;
use crate::session::error::RunError;
use line::line_hash;

/// The line that says how a run ended, among its lines; none while it is unfinished.
pub fn end_of(lines: &[Line]) -> Option<&Line> {
    lines.iter().rev().find(|line| matches!(line.record, Record::End(_)))
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
    /// The line that its first one goes on from, of a file that goes on from another.
    goes_on_from: Option<Position>,
}

impl Trajectory {
    /// Reads and checks a file: every line is JSON, numbered, and names the hash of the one before.
    ///
    /// # Errors
    /// The file cannot be read, or a line is damaged; the error names it and says what is still good.
    pub fn read(path: &Path) -> Result<Trajectory, RunError> {
        Trajectory::of_file(path, &read_regular_file(path).map_err(RunError::io(path))?)
    }

    /// The line that says how the run ended; none while it is unfinished. In runs of format 1 others can follow it.
    pub fn end(&self) -> Option<&Line> {
        end_of(&self.lines)
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

    /// Checks the bytes of a file whose lines go on from the last of another.
    ///
    /// # Errors
    /// A line is damaged; the error names it and says what is still good.
    pub fn of_file_after(path: &Path, last: Position, bytes: &[u8]) -> Result<Trajectory, RunError> {
        let mut trajectory = Trajectory { goes_on_from: Some(last), ..Trajectory::default() };
        trajectory.extend(bytes).map_err(damaged_at(path))?;
        Ok(trajectory)
    }

    /// Number of the line that follows.
    pub(super) fn next_seq(&self) -> u64 {
        self.goes_on_from.as_ref().map_or(0, |last| last.seq + 1) + self.lines.len() as u64
    }

    /// What the line that follows has to name.
    pub(super) fn last_hash(&self) -> String {
        let before =
            || self.goes_on_from.as_ref().map_or_else(|| line_hash(b""), |last| last.line_hash.clone());
        self.lines.last().map_or_else(before, |line| line.hash.clone())
    }

    /// Whether every line ends with a sum. Before the first line is read nobody knows.
    fn has_sums(&self) -> bool {
        self.goes_on_from.is_some() || self.lines.first().is_none_or(Line::promises_sums)
    }

    /// Takes what follows in the file after the lines that are known.
    ///
    /// # Errors
    /// (line, problem), lines from 1. The lines before it are kept.
    pub fn extend(&mut self, bytes: &[u8]) -> Result<(), (usize, String)> {
        let end = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        for text in bytes[..end].split_inclusive(|byte| *byte == b'\n') {
            let line = &text[..text.len() - 1];
            let number = self.lines.len() + 1;
            let line = Line::read(line, self.next_seq(), &self.last_hash(), self.has_sums())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::folder::configuration::Configuration;
    use crate::session::folder::create::NewRun;
    use crate::session::trajectory::record::{Activity, Memo, Query, QuerySource, View};
    use serde_json::{Value, json};
    use std::path::PathBuf;

    fn memo() -> Record {
        Record::Memo(Memo { digest: "größer".to_owned(), length: 7 })
    }

    fn start() -> Record {
        let manifest = crate::session::state::Session::create(NewRun::default(), &Configuration::shipped())
            .expect("a run")
            .manifest()
            .clone();
        crate::session::folder::first_line::start_of(&manifest)
    }

    /// A start, and memos after it.
    fn written(folder: &Path, count: u32) -> PathBuf {
        let path = folder.join("trajectory.jsonl");
        let mut writer = TrajectoryWriter::create(&path).expect("a file");
        writer.append(0, &start(), Durability::Synced).expect("a line");
        for day in 1..count {
            writer.append(day, &memo(), Durability::Synced).expect("a line");
        }
        path
    }

    #[test]
    fn recorded_lines_are_written_again_with_the_same_bytes() {
        let recorded = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/recorded");
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
                let own = Value::Object(line.own_fields()).to_string();
                assert_eq!(fields, own, "{}: line {}", path.display(), line.seq + 1);
                assert!(text.contains(&own[1..own.len() - 1]), "{}: line {}", path.display(), line.seq + 1);
                count += 1;
            }
        }
        assert!(count > 400, "{count}");
    }

    #[test]
    fn lines_come_back_and_can_be_continued() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = written(folder.path(), 3);
        let read = Trajectory::read(&path).expect("it reads");
        assert_eq!(read.lines.len(), 3);
        assert_eq!((read.lines[2].day, &read.lines[2].record), (2, &memo()));
        let mut writer = TrajectoryWriter::resume(&path, &read).expect("it opens");
        assert_eq!(writer.position(), read.lines[2].position());
        writer.append(9, &memo(), Durability::Written).expect("a line");
        assert_eq!(Trajectory::read(&path).expect("it reads").lines[3].day, 9);
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
        writer.append(2, &memo(), Durability::Synced).expect("a line");
        assert_eq!(Trajectory::read(&path).expect("it reads").lines.len(), 3);
    }

    #[test]
    fn a_file_that_is_gone_or_grew_elsewhere_takes_no_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = written(folder.path(), 3);
        let read = Trajectory::read(&path).expect("it reads");
        let [mut first, mut second] =
            [(), ()].map(|()| TrajectoryWriter::resume(&path, &read).expect("it opens"));
        let note = |writer: &mut TrajectoryWriter| writer.append(9, &memo(), Durability::Synced);
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
    fn what_was_confirmed_is_written_beside_a_file_that_is_gone() {
        let runs = tempfile::tempdir().expect("a folder");
        let folder = runs.path().join("0123abcd");
        std::fs::create_dir(&folder).expect("a folder");
        let path = written(&folder, 3);
        let whole = std::fs::read(&path).expect("bytes");
        let mut writer =
            TrajectoryWriter::resume(&path, &Trajectory::read(&path).expect("it reads")).expect("it opens");
        assert_eq!(writer.loss(), None);
        let kept = |error: RunError| match error {
            RunError::Astray { kept: Ok(file), .. } => file,
            other => panic!("{other}"),
        };
        #[cfg(unix)]
        {
            std::fs::hard_link(&path, folder.join("another-name")).expect("a link");
            let error = writer.append(9, &memo(), Durability::Synced).expect_err("it has another name");
            let words = error.to_string();
            assert!(words.contains("no longer on disk") && words.contains("linked"), "{words}");
            assert_eq!(std::fs::read(kept(error)).expect("a copy"), whole);
            std::fs::remove_file(folder.join("another-name")).expect("removed");
            writer.append(9, &memo(), Durability::Synced).expect("it is as it was");
        }
        let confirmed = std::fs::read(&path).expect("bytes");
        std::fs::remove_dir_all(&folder).expect("the whole folder is gone");
        // A week that ran cannot be taken back: its line is kept with the others.
        let aside = kept(writer.append_done(9, &memo()).expect_err("there is no file"));
        assert_eq!(aside.parent(), Some(folder.as_path()));
        let told = writer.loss().expect("it is lost").to_owned();
        assert!(told.contains("trajectory-unsaved-") && told.contains("open the run again"), "{told}");
        let saved = std::fs::read(&aside).expect("a copy");
        assert!(saved.starts_with(&confirmed) && saved.len() > confirmed.len());
        assert_eq!(
            kept(writer.append(9, &memo(), Durability::Synced).expect_err("still")),
            aside,
            "one file"
        );
        // A copy that cannot be replaced by a whole one is kept.
        let draft = aside.with_extension("draft");
        std::fs::create_dir(&draft).expect("in the way");
        let error = writer.append_done(9, &memo()).expect_err("there is no file");
        let RunError::Astray { kept: Err(problem), .. } = error else { panic!("{error}") };
        assert!(problem.contains("holds an earlier copy"), "{problem}");
        assert_eq!(std::fs::read(&aside).expect("a copy"), saved);
        std::fs::remove_dir(&draft).expect("removed");
        kept(writer.append_done(9, &memo()).expect_err("there is no file"));
        // With the name of the trajectory it is one.
        std::fs::rename(&aside, &path).expect("renamed");
        let read = Trajectory::read(&path).expect("a whole chain");
        assert_eq!(read.lines.last().map(Line::position), Some(writer.position()));
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

    /// The examples of the schema, one of each kind, without their frame.
    fn examples() -> Vec<(String, Value)> {
        let schema: Value =
            serde_json::from_str(include_str!("../../../assets/trajectory.schema.json")).expect("JSON");
        let kinds = schema["$defs"].as_object().expect("definitions");
        let examples = kinds.iter().filter_map(|(kind, own)| Some((kind, own.get("examples")?.as_array()?)));
        examples.flat_map(|(kind, all)| all.iter().map(|one| (kind.clone(), one.clone()))).collect()
    }

    #[test]
    fn every_kind_is_read_and_written_as_the_schema_shows_it() {
        let examples = examples();
        for (kind, example) in &examples {
            let text = example.to_string();
            let record = Record::read(kind, text.as_bytes()).expect(kind);
            assert_eq!(record.kind(), kind);
            let fields = example.as_object().expect("an object").iter();
            let own = fields
                .filter(|(name, _)| !["seq", "kind", "day", "at", "prev", "sum"].contains(&name.as_str()));
            let own: serde_json::Map<String, Value> =
                own.map(|(name, value)| (name.clone(), value.clone())).collect();
            assert_eq!(Value::Object(record.fields()).to_string(), Value::Object(own).to_string());
        }
        let kinds: std::collections::BTreeSet<&str> =
            examples.iter().map(|(kind, _)| kind.as_str()).collect();
        assert_eq!(kinds.len(), 25, "{kinds:?}");
    }

    #[test]
    fn a_field_that_is_missing_is_an_error_and_one_that_is_unknown_is_kept() {
        for (kind, example) in examples() {
            let (seq, previous) =
                (example["seq"].as_u64().expect("a number"), example["prev"].as_str().expect("a hash"));
            let read = |fields: &Value| Line::read(fields.to_string().as_bytes(), seq, previous, false);
            let mut without_sum = example.clone();
            let fields = without_sum.as_object_mut().expect("an object");
            fields.remove("sum");
            fields.insert("later".to_owned(), json!([1, "two"]));
            assert_eq!(read(&without_sum).expect(&kind).own_fields()["later"], json!([1, "two"]));
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
    fn what_is_written_is_read_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = written(folder.path(), 1);
        let read = Trajectory::read(&path).expect("it reads");
        let mut writer = TrajectoryWriter::resume(&path, &read).expect("it opens");
        let query = Query {
            sql: "SELECT 1".to_owned(),
            rows: None,
            truncated: false,
            error: Some("sql_error".to_owned()),
            message: Some("no such column".to_owned()),
            stopped: false,
            via: Some(QuerySource::Typed),
            took_ms: 3.0,
        };
        let view = View { screen: "cash".to_owned(), from: "sql".to_owned(), for_ms: 12 };
        let records = [start(), Record::Query(query), Record::Activity(Activity::View(view)), memo()];
        for record in &records {
            writer.append(3, record, Durability::Written).expect("a line");
        }
        let lines = Trajectory::read(&path).expect("it reads").lines;
        let kept: Vec<&Record> = lines[1..].iter().map(|line| &line.record).collect();
        assert_eq!(kept, records.iter().collect::<Vec<_>>());
    }
}
