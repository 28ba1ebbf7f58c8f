//! Tests of failed syncs: confirmed lines survive a power cut (docs/formats/trajectory.md#durability).

use std::path::Path;

use crate::create::NewRun;
use crate::play::Session;
use novamind_record::files::sync_probe;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::manifest::to_start_record;
use novamind_record::trajectory::record::Memo;
use novamind_record::trajectory::{Durability, PageCache, Record, Trajectory, TrajectoryWriter};

/// Creates a trajectory with its first line, on a disk whose syncs can fail.
fn new_writer(folder: &Path) -> (TrajectoryWriter, PageCache) {
    let path = folder.join("trajectory.jsonl");
    let run = Session::create(NewRun::default(), &Configuration::bundled()).expect("a run");
    let mut writer = TrajectoryWriter::create(&path).expect("a file");
    writer.append(0, &to_start_record(run.manifest()), Durability::Synced).expect("a line");
    let cache = PageCache::with_synced_bytes(std::fs::read(&path).expect("bytes"));
    writer.replace_medium(Box::new(cache.clone()));
    (writer, cache)
}

fn memo_record(length: u64) -> Record {
    Record::Memo(Memo { digest: "größer".to_owned(), length })
}

/// Returns the lengths of the memos in a file without unfinished lines.
fn memo_lengths(bytes: &[u8]) -> Vec<u64> {
    let read = Trajectory::parse(bytes).unwrap_or_else(|(line, problem)| panic!("line {line}: {problem}"));
    assert_eq!(read.unfinished_bytes, 0);
    let length = |record: &Record| match record {
        Record::Memo(memo) => Some(memo.length),
        _ => None,
    };
    read.lines.iter().filter_map(|line| length(&line.record)).collect()
}

#[test]
fn sync_retry_rewrites_earlier_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut writer, cache) = new_writer(folder.path());
    writer.append(1, &memo_record(1), Durability::Written).expect("a line");
    writer.append(1, &memo_record(2), Durability::Written).expect("a line");
    assert_eq!(memo_lengths(&cache.bytes_after_power_cut()), [0; 0]);
    cache.fail_next_syncs(1);
    writer.append(1, &memo_record(3), Durability::Synced).expect("the second sync succeeds");
    assert_eq!(memo_lengths(&cache.bytes_after_power_cut()), [1, 2, 3]);
}

#[test]
fn failed_append_keeps_earlier_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut writer, cache) = new_writer(folder.path());
    writer.append(1, &memo_record(1), Durability::Written).expect("a line");
    for failing in 2..6 {
        let position = writer.last_position();
        cache.fail_next_syncs(failing);
        assert!(writer.append(1, &memo_record(2), Durability::Synced).is_err());
        assert_eq!(writer.last_position(), position);
        assert!(!writer.is_complete() && writer.has_unsynced_lines());
        assert_eq!(
            memo_lengths(&cache.bytes_after_kill()).last(),
            Some(&1),
            "killing the program loses nothing"
        );
        cache.fail_next_syncs(0);
        // Appending the next line does not sync that line, but rewrites and syncs the earlier lines.
        writer.append(1, &memo_record(1), Durability::Written).expect("a line");
        assert!(memo_lengths(&cache.bytes_after_power_cut()).iter().all(|length| *length == 1));
    }
    writer.append(1, &memo_record(3), Durability::Synced).expect("a line");
    assert_eq!(memo_lengths(&cache.bytes_after_power_cut()), [1, 1, 1, 1, 1, 3]);
    assert!(writer.is_complete() && !writer.has_unsynced_lines());
}

#[test]
fn irrevocable_line_waits_with_earlier_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut writer, cache) = new_writer(folder.path());
    writer.append(1, &memo_record(1), Durability::Written).expect("a line");
    cache.fail_next_syncs(2);
    assert!(writer.append_irrevocable(1, &memo_record(2)).is_err());
    cache.set_full(true);
    assert!(writer.append_irrevocable(1, &memo_record(3)).is_err());
    cache.set_full(false);
    writer.append(1, &memo_record(4), Durability::Written).expect("a line");
    assert_eq!(memo_lengths(&cache.bytes_after_power_cut()), [1, 2, 3, 4], "the pending lines are synced");
}

#[test]
fn sync_succeeds_only_after_a_rewrite() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut writer, cache) = new_writer(folder.path());
    writer.append(1, &memo_record(1), Durability::Written).expect("a line");
    cache.fail_next_syncs(1);
    writer.sync_written().expect("the second sync succeeds");
    assert_eq!(memo_lengths(&cache.bytes_after_power_cut()), [1]);
    for length in 2..4 {
        writer.append(1, &memo_record(length), Durability::Written).expect("a line");
        cache.fail_next_syncs(2);
        assert!(writer.sync_written().is_err());
        match length {
            2 => writer.sync_written().expect("the disk works again"),
            _ => writer.sync().expect("the disk works again"),
        }
        assert_eq!(memo_lengths(&cache.bytes_after_power_cut()).last(), Some(&length));
    }
}

#[test]
fn full_disk_keeps_unsynced_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut writer, cache) = new_writer(folder.path());
    writer.append(1, &memo_record(1), Durability::Written).expect("a line");
    cache.set_full(true);
    assert!(writer.append(1, &memo_record(2), Durability::Synced).is_err());
    assert_eq!(memo_lengths(&cache.bytes_after_kill()), [1]);
    cache.set_full(false);
    writer.append(1, &memo_record(3), Durability::Synced).expect("a line");
    assert_eq!(memo_lengths(&cache.bytes_after_power_cut()), [1, 3]);
}

#[test]
fn writer_creates_no_file_if_the_folder_cannot_be_synced() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("afterwards.jsonl");
    sync_probe::reset(true);
    assert!(TrajectoryWriter::create(&path).is_err());
    assert!(!path.exists(), "the next attempt can create the file again");
    sync_probe::reset(false);
    TrajectoryWriter::create(&path).expect("a file");
    assert!(sync_probe::has_synced(&path));
}

#[cfg(unix)]
#[test]
fn open_after_rejects_non_regular_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let (writer, _) = new_writer(folder.path());
    let place = |name: &str| folder.path().join(name);
    let made = std::process::Command::new("mkfifo").arg(place("pipe")).status().expect("mkfifo");
    assert!(made.success());
    std::fs::create_dir(place("folder")).expect("a folder");
    std::os::unix::fs::symlink(place("nothing"), place("link")).expect("a link");
    std::os::unix::fs::symlink("/dev/zero", place("device")).expect("a link");
    for name in ["pipe", "folder", "link", "device"] {
        assert!(TrajectoryWriter::open_after(&place(name), writer.last_position()).is_err(), "{name}");
    }
    assert!(!place("nothing").exists());
}
