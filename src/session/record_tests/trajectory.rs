//! Tests of reading and checking a trajectory.

use crate::create::NewRun;
use novamind_record::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::{Activity, Memo, Query, QuerySource, ScreenView};
use novamind_record::trajectory::*;
use std::path::Path;
use std::path::PathBuf;

fn memo_record() -> Record {
    Record::Memo(Memo { digest: "größer".to_owned(), length: 7 })
}

fn start_record() -> Record {
    let manifest = crate::play::Session::create(NewRun::default(), &Configuration::bundled())
        .expect("a run")
        .manifest()
        .clone();
    novamind_record::folder::manifest::to_start_record(&manifest)
}

fn write_trajectory(folder: &Path, count: u32) -> PathBuf {
    let path = folder.join("trajectory.jsonl");
    let mut writer = TrajectoryWriter::create(&path).expect("a file");
    writer.append(0, &start_record(), Durability::Synced).expect("a line");
    for day in 1..count {
        writer.append(day, &memo_record(), Durability::Synced).expect("a line");
    }
    path
}

#[test]
fn trajectory_round_trips_and_can_be_continued() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = write_trajectory(folder.path(), 3);
    let read = Trajectory::read(&path).expect("it reads");
    assert_eq!(read.lines.len(), 3);
    assert_eq!((read.lines[2].day, &read.lines[2].record), (2, &memo_record()));
    let mut writer = TrajectoryWriter::resume(&path, &read).expect("it opens");
    assert_eq!(writer.last_position(), read.lines[2].position());
    writer.append(9, &memo_record(), Durability::Written).expect("a line");
    assert_eq!(Trajectory::read(&path).expect("it reads").lines[3].day, 9);
    assert!(TrajectoryWriter::create(&path).is_err());
}

#[test]
fn unfinished_line_is_dropped() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = write_trajectory(folder.path(), 3);
    let bytes = std::fs::read(&path).expect("bytes");
    std::fs::write(&path, &bytes[..bytes.len() - 5]).expect("a cut");
    let read = Trajectory::read(&path).expect("it reads");
    assert_eq!(read.lines.len(), 2);
    assert!(read.unfinished_bytes > 0);
    let mut writer = TrajectoryWriter::resume(&path, &read).expect("it opens");
    writer.append(2, &memo_record(), Durability::Synced).expect("a line");
    assert_eq!(Trajectory::read(&path).expect("it reads").lines.len(), 3);
}

#[test]
fn append_fails_if_the_file_was_replaced_or_changed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = write_trajectory(folder.path(), 3);
    let read = Trajectory::read(&path).expect("it reads");
    let [mut first, mut second] =
        [(), ()].map(|()| TrajectoryWriter::resume(&path, &read).expect("it opens"));
    let note = |writer: &mut TrajectoryWriter| writer.append(9, &memo_record(), Durability::Synced);
    note(&mut second).expect("a line");
    let kept = std::fs::read(&path).expect("bytes");
    assert!(
        matches!(note(&mut first), Err(RunError::FileReplaced { .. })),
        "another writer has appended a line"
    );
    assert_eq!(std::fs::read(&path).expect("bytes"), kept, "the other writer's line is kept");
    std::fs::rename(&path, folder.path().join("aside")).expect("moved");
    assert!(matches!(note(&mut second), Err(RunError::FileReplaced { .. })), "it was moved");
    std::fs::copy(folder.path().join("aside"), &path).expect("a copy");
    assert!(matches!(note(&mut second), Err(RunError::FileReplaced { .. })), "a copy is another file");
    std::fs::remove_file(&path).expect("removed");
    std::fs::rename(folder.path().join("aside"), &path).expect("moved back");
    note(&mut second).expect("the file was moved back");
}

#[test]
fn confirmed_lines_are_saved_next_to_a_lost_file() {
    let runs = tempfile::tempdir().expect("a folder");
    let folder = runs.path().join("0123abcd");
    std::fs::create_dir(&folder).expect("a folder");
    let path = write_trajectory(&folder, 3);
    let whole = std::fs::read(&path).expect("bytes");
    let mut writer =
        TrajectoryWriter::resume(&path, &Trajectory::read(&path).expect("it reads")).expect("it opens");
    assert_eq!(writer.loss_reason(), None);
    let kept = |error: RunError| match error {
        RunError::FileReplaced { saved_copy: Ok(file), .. } => file,
        other => panic!("{other}"),
    };
    #[cfg(unix)]
    {
        std::fs::hard_link(&path, folder.join("another-name")).expect("a link");
        let error =
            writer.append(9, &memo_record(), Durability::Synced).expect_err("the file has another name");
        let words = error.to_string();
        assert!(words.contains("no longer on disk") && words.contains("linked"), "{words}");
        assert_eq!(std::fs::read(kept(error)).expect("a copy"), whole);
        std::fs::remove_file(folder.join("another-name")).expect("removed");
        writer.append(9, &memo_record(), Durability::Synced).expect("the file was restored");
    }
    let confirmed = std::fs::read(&path).expect("bytes");
    std::fs::remove_dir_all(&folder).expect("the whole folder is gone");
    // A simulated week cannot be reverted, so its line is included in the copy.
    let aside = kept(writer.append_irrevocable(9, &memo_record()).expect_err("there is no file"));
    assert_eq!(aside.parent(), Some(folder.as_path()));
    let text = writer.loss_reason().expect("it is lost").to_owned();
    assert!(text.contains("trajectory-unsaved-") && text.contains("open the run again"), "{text}");
    let saved = std::fs::read(&aside).expect("a copy");
    assert!(saved.starts_with(&confirmed) && saved.len() > confirmed.len());
    assert_eq!(
        kept(writer.append(9, &memo_record(), Durability::Synced).expect_err("still")),
        aside,
        "one file"
    );
    // An earlier copy is kept if it cannot be replaced.
    let draft = aside.with_extension("draft");
    std::fs::create_dir(&draft).expect("a folder at the path of the file");
    let error = writer.append_irrevocable(9, &memo_record()).expect_err("there is no file");
    let RunError::FileReplaced { saved_copy: Err(problem), .. } = error else { panic!("{error}") };
    assert!(problem.contains("contains an earlier copy"), "{problem}");
    assert_eq!(std::fs::read(&aside).expect("a copy"), saved);
    std::fs::remove_dir(&draft).expect("removed");
    kept(writer.append_irrevocable(9, &memo_record()).expect_err("there is no file"));
    // The renamed copy is a valid trajectory.
    std::fs::rename(&aside, &path).expect("renamed");
    let read = Trajectory::read(&path).expect("a whole chain");
    assert_eq!(read.lines.last().map(Line::position), Some(writer.last_position()));
}

#[test]
fn parse_detects_flipped_bytes_and_missing_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = std::fs::read(write_trajectory(folder.path(), 4)).expect("bytes");
    let trajectory = Trajectory::parse(&bytes).expect("it reads");
    // Without its line feed, the last line counts as unfinished.
    for at in 0..bytes.len() - 1 {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x04;
        assert!(Trajectory::parse(&damaged).is_err(), "the change of byte {at} was not detected");
    }
    let mut lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
    lines.remove(1);
    assert_eq!(Trajectory::parse(&lines.concat()).expect_err("a line is missing").0, 2);
    lines.swap(0, 1);
    assert_eq!(Trajectory::parse(&lines.concat()).expect_err("out of order").0, 1);
    assert_eq!(trajectory.unfinished_bytes, 0);
    assert_eq!(Trajectory::parse(b"").expect("an empty file").lines.len(), 0);
}

#[test]
fn records_round_trip() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = write_trajectory(folder.path(), 1);
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
    let view = ScreenView { screen: "cash".to_owned(), from: "sql".to_owned(), for_ms: 12 };
    let records =
        [start_record(), Record::Query(query), Record::Activity(Activity::View(view)), memo_record()];
    for record in &records {
        writer.append(3, record, Durability::Written).expect("a line");
    }
    let lines = Trajectory::read(&path).expect("it reads").lines;
    let kept: Vec<&Record> = lines[1..].iter().map(|line| &line.record).collect();
    assert_eq!(kept, records.iter().collect::<Vec<_>>());
}
