//! The trajectory of a run is removed while the run is played: the run stops, and no confirmed action is lost.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;

use serde_json::Value;

use crate::support::home::{Home, read_bytes, run_id};

fn unsaved_files(folder: &std::path::Path) -> Vec<PathBuf> {
    let files = fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path());
    let is_unsaved = |path: &PathBuf| {
        path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("trajectory-unsaved-"))
    };
    files.filter(is_unsaved).collect()
}

#[test]
fn deleted_trajectory_stops_the_run_and_can_be_restored() {
    let home = Home::new();
    let mut child =
        home.program().args(["play", "--plain", "--json", "--days", "28"]).spawn().expect("it starts");
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let mut stdin = child.stdin.take().expect("a pipe");
    let mut next =
        || -> Value { serde_json::from_str(&lines.next().expect("a line").expect("text")).expect("JSON") };
    assert_eq!(next()["event"], "start");
    for command in ["set_prices A=12", "next naive"] {
        writeln!(stdin, "{command}").expect("it reads");
        assert_eq!(next()["ok"], true, "{command}");
    }
    let folder = home.only_run();
    let confirmed = read_bytes(&folder, "trajectory.jsonl");
    fs::remove_file(folder.join("trajectory.jsonl")).expect("deleted");
    writeln!(stdin, "set_prices B=20").expect("it reads");
    let refused = next();
    assert_eq!((refused["ok"].as_bool(), refused["code"].as_str()), (Some(false), Some("not_saved")));
    let words = refused.to_string();
    assert!(
        words.contains("your decisions are no longer on disk") && !words.contains("disk space"),
        "{words}"
    );
    // The program ends without waiting for further input.
    let end = next();
    assert_eq!((end["event"].as_str(), end["reason"].as_str()), (Some("end"), Some("record_lost")));
    assert_eq!(child.wait().expect("it ends").code(), Some(3));
    let files = unsaved_files(&folder);
    let [aside] = files.as_slice() else { panic!("one file is kept: {files:?}") };
    assert!(words.contains(aside.file_name().expect("a name").to_str().expect("text")), "{words}");
    assert!(fs::read(aside).expect("a copy").starts_with(&confirmed));
    fs::rename(aside, folder.join("trajectory.jsonl")).expect("renamed");
    let id = run_id(&folder);
    let program_output = home.play(&["--run", &id, "--json"], "set_prices B=20\n");
    assert!(
        program_output.exit_code == 0 && program_output.stdout.contains("\"ok\":true"),
        "{}{}",
        program_output.stdout,
        program_output.stderr
    );
    assert_eq!(home.run(&["replay", &id, "--verify"]).exit_code, 0);
}
