//! Tests of the manifest, which is derived from the first line of a run.

use crate::play::Session;
use crate::play::open::Access;
use crate::playback::tests::record_run;
use crate::resume::verify::verify;
use novamind_record::folder::runs::{find_run, list_runs};
use novamind_record::mode::Mode;
use std::path::Path;
use toml::Table;

/// Opens a run with this text as `run.toml`, or without the file. Returns the remarks of the session.
fn open_and_read_remarks(folder: &Path, text: Option<&str>) -> String {
    let path = folder.join("run.toml");
    match text {
        Some(text) => std::fs::write(&path, text).expect("written"),
        None => std::fs::remove_file(&path).expect("removed"),
    }
    let runs = folder.parent().expect("runs");
    let id = folder.file_name().expect("a name").to_string_lossy().into_owned();
    let listed = list_runs(runs).expect("a list");
    assert_eq!((listed.len(), &listed[0].id, listed[0].seed), (1, &id, 7));
    assert_eq!((listed[0].problem.as_ref(), listed[0].participant.as_ref()), (None, None));
    assert_eq!(find_run(runs, "latest").expect("a run"), folder);
    assert!(verify(folder).is_ok(), "the unchanged run verifies");
    assert_eq!(std::fs::read_to_string(&path).ok().as_deref(), text, "reading changes nothing");
    let reader = Session::open(folder, Access::Read, false).expect("it opens");
    assert!(reader.remarks().join(" ").contains("the first line of the trajectory is used"));
    let session = Session::open(folder, Access::Write, true).expect("it opens");
    assert_eq!((session.day(), session.manifest().mode, session.manifest().seed), (14, Mode::Baseline, 7));
    session.remarks().join(" ")
}

#[test]
fn manifest_is_restored_from_the_first_line() {
    let run = record_run(Mode::Baseline, 2);
    let path = run.folder.join("run.toml");
    let good = std::fs::read_to_string(&path).expect("a manifest");
    let edit = |from: &str, to: &str| {
        assert!(good.contains(from), "{from} in {good}");
        good.replacen(from, to, 1)
    };
    let cases = [
        (Some(edit("seed = 7", "seed = 8")), "differed (seed)"),
        (Some(edit("mode = \"baseline\"", "mode = \"debug\"\nparticipant = \"P99\"")), "(mode, participant)"),
        (Some(edit("days = 35", "days = 350")), "(days)"),
        (Some(edit("cash = 1000000.0", "cash = 9000000.0")), "(cash)"),
        (Some(edit(&format!("id = \"{}\"", run.id), "id = \"00000000\"")), "(id)"),
        (Some(edit("parameters_digest = \"", "parameters_digest = \"0")), "(parameters_digest)"),
        (Some("seed = [".to_owned()), "was damaged (line 1"),
        (Some(String::new()), "was damaged"),
        (None, "was missing"),
    ];
    for (text, problem) in cases {
        let remark = open_and_read_remarks(&run.folder, text.as_deref());
        assert!(remark.contains(problem) && remark.contains("rebuilt"), "{problem}: {remark}");
        let restored: Table = std::fs::read_to_string(&path).expect("a manifest").parse().expect("TOML");
        let mut expected: Table = good.parse().expect("TOML");
        if text.is_none_or(|text| !text.contains("created")) {
            // Only `run.toml` contains the creation time.
            expected["created"] = restored["created"].clone();
        }
        assert_eq!(restored, expected, "{problem}");
        let session = Session::open(&run.folder, Access::Write, true).expect("it opens");
        assert_eq!(session.remarks(), [""; 0], "the remark appears once");
    }
}

#[test]
fn mixed_files_of_two_runs_are_rejected() {
    let (one, other) = (record_run(Mode::Sandbox, 1), record_run(Mode::Sandbox, 1));
    std::fs::copy(other.folder.join("trajectory.jsonl"), one.folder.join("trajectory.jsonl"))
        .expect("copied");
    let error = Session::open(&one.folder, Access::Write, true).err().expect("it is rejected").to_string();
    assert!(error.contains("contradicts run.toml"), "{error}");
}
