//! Tests of failed syncs: confirmed lines survive a power cut (docs/formats/trajectory.md#durability).

use std::path::Path;

use crate::create::NewRun;
use crate::play::Session;
use novamind_record::files::probe;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::manifest::start_of;
use novamind_record::trajectory::record::Memo;
use novamind_record::trajectory::{Durability, PageCache, Record, Trajectory, TrajectoryWriter};

/// Creates a trajectory with its first line, on a disk whose syncs can fail.
fn writer(folder: &Path) -> (TrajectoryWriter, PageCache) {
    let path = folder.join("trajectory.jsonl");
    let run = Session::create(NewRun::default(), &Configuration::shipped()).expect("a run");
    let mut writer = TrajectoryWriter::create(&path).expect("a file");
    writer.append(0, &start_of(run.manifest()), Durability::Synced).expect("a line");
    let cache = PageCache::holding(std::fs::read(&path).expect("bytes"));
    writer.write_to(Box::new(cache.clone()));
    (writer, cache)
}

fn memo(length: u64) -> Record {
    Record::Memo(Memo { digest: "größer".to_owned(), length })
}

/// Returns the lengths of the memos in a file without unfinished lines.
fn memos(bytes: &[u8]) -> Vec<u64> {
    let read = Trajectory::parse(bytes).unwrap_or_else(|(line, problem)| panic!("line {line}: {problem}"));
    assert_eq!(read.unfinished, 0);
    let length = |record: &Record| match record {
        Record::Memo(memo) => Some(memo.length),
        _ => None,
    };
    read.lines.iter().filter_map(|line| length(&line.record)).collect()
}

#[test]
fn a_line_is_confirmed_only_after_the_lines_before_it_were_written_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut writer, cache) = writer(folder.path());
    writer.append(1, &memo(1), Durability::Written).expect("a line");
    writer.append(1, &memo(2), Durability::Written).expect("a line");
    assert_eq!(memos(&cache.after_a_power_cut()), [0; 0]);
    cache.fail_syncs(1);
    writer.append(1, &memo(3), Durability::Synced).expect("the second sync succeeds");
    assert_eq!(memos(&cache.after_a_power_cut()), [1, 2, 3]);
}

#[test]
fn a_line_that_no_sync_takes_does_not_exist_and_loses_no_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut writer, cache) = writer(folder.path());
    writer.append(1, &memo(1), Durability::Written).expect("a line");
    for failing in 2..6 {
        let position = writer.position();
        cache.fail_syncs(failing);
        assert!(writer.append(1, &memo(2), Durability::Synced).is_err());
        assert_eq!(writer.position(), position);
        assert!(!writer.is_complete() && writer.has_unsynced_lines());
        assert_eq!(memos(&cache.after_a_kill()).last(), Some(&1), "killing the program loses nothing");
        cache.fail_syncs(0);
        // The next line is not synced itself, but follows a rewrite that is.
        writer.append(1, &memo(1), Durability::Written).expect("a line");
        assert!(memos(&cache.after_a_power_cut()).iter().all(|length| *length == 1));
    }
    writer.append(1, &memo(3), Durability::Synced).expect("a line");
    assert_eq!(memos(&cache.after_a_power_cut()), [1, 1, 1, 1, 1, 3]);
    assert!(writer.is_complete() && !writer.has_unsynced_lines());
}

#[test]
fn a_line_that_cannot_be_taken_back_waits_with_those_before_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut writer, cache) = writer(folder.path());
    writer.append(1, &memo(1), Durability::Written).expect("a line");
    cache.fail_syncs(2);
    assert!(writer.append_done(1, &memo(2)).is_err());
    cache.set_full(true);
    assert!(writer.append_done(1, &memo(3)).is_err());
    cache.set_full(false);
    writer.append(1, &memo(4), Durability::Written).expect("a line");
    assert_eq!(memos(&cache.after_a_power_cut()), [1, 2, 3, 4], "the pending lines are synced");
}

#[test]
fn a_sync_succeeds_only_after_a_rewrite() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut writer, cache) = writer(folder.path());
    writer.append(1, &memo(1), Durability::Written).expect("a line");
    cache.fail_syncs(1);
    writer.sync_written().expect("the second sync succeeds");
    assert_eq!(memos(&cache.after_a_power_cut()), [1]);
    for length in 2..4 {
        writer.append(1, &memo(length), Durability::Written).expect("a line");
        cache.fail_syncs(2);
        assert!(writer.sync_written().is_err());
        match length {
            2 => writer.sync_written().expect("the disk works again"),
            _ => writer.sync().expect("the disk works again"),
        }
        assert_eq!(memos(&cache.after_a_power_cut()).last(), Some(&length));
    }
}

#[test]
fn a_full_disk_takes_nothing_from_lines_that_wait_for_a_sync() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut writer, cache) = writer(folder.path());
    writer.append(1, &memo(1), Durability::Written).expect("a line");
    cache.set_full(true);
    assert!(writer.append(1, &memo(2), Durability::Synced).is_err());
    assert_eq!(memos(&cache.after_a_kill()), [1]);
    cache.set_full(false);
    writer.append(1, &memo(3), Durability::Synced).expect("a line");
    assert_eq!(memos(&cache.after_a_power_cut()), [1, 3]);
}

#[test]
fn a_file_whose_folder_cannot_be_synced_is_not_created() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("afterwards.jsonl");
    probe::reset(true);
    assert!(TrajectoryWriter::create(&path).is_err());
    assert!(!path.exists(), "the next attempt creates the name again");
    probe::reset(false);
    TrajectoryWriter::create(&path).expect("a file");
    assert!(probe::has_synced(&path));
}

#[cfg(unix)]
#[test]
fn a_pipe_a_folder_or_a_dangling_link_in_the_place_of_a_file_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let (writer, _) = writer(folder.path());
    let place = |name: &str| folder.path().join(name);
    let made = std::process::Command::new("mkfifo").arg(place("pipe")).status().expect("mkfifo");
    assert!(made.success());
    std::fs::create_dir(place("folder")).expect("a folder");
    std::os::unix::fs::symlink(place("nothing"), place("link")).expect("a link");
    std::os::unix::fs::symlink("/dev/zero", place("device")).expect("a link");
    for name in ["pipe", "folder", "link", "device"] {
        assert!(TrajectoryWriter::open_after(&place(name), writer.position()).is_err(), "{name}");
    }
    assert!(!place("nothing").exists());
}
