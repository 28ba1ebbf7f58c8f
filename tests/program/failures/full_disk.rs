//! A full disk: actions that cannot be saved have no effect, and confirmed actions are not lost.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support::home::{Home, ProgramOutput, read_bytes, run_id, run_with_input, split_lines};

/// Maximum size of a file in blocks of 512 bytes.
const BLOCKS: usize = 2048;
/// Number of bytes by which a padded SQL statement lengthens its line of the trajectory.
const PADDING: usize = 490_000;

/// Plays with a file size limit, which simulates a full disk.
fn play_with_file_limit(home: &Home, options: &str, lines: &str) -> ProgramOutput {
    let program = env!("CARGO_BIN_EXE_novamind");
    let script = format!("trap '' XFSZ; ulimit -f {BLOCKS}; exec '{program}' play --plain --json {options}");
    run_with_input(home.command("sh").args(["-c", &script]), lines)
}

fn padding(length: usize) -> String {
    format!("sql SELECT LENGTH('{}') AS n\n", "x".repeat(length))
}

fn trajectory_length(folder: &Path) -> usize {
    read_bytes(folder, "trajectory.jsonl").len()
}

fn last_price(objects: &[Value]) -> Option<f64> {
    let changes = objects.iter().rev().find(|object| object["command"] == "changes")?;
    let all = changes["data"]["changes"].as_array()?;
    all.iter().find(|change| change["setting"] == "price A")?["new"].as_f64()
}

#[test]
fn unsaved_call_has_no_effect() {
    let home = Home::new();
    let mut lines = "set_prices A=10\n".to_owned() + &padding(PADDING) + &padding(PADDING);
    for amount in 11..400 {
        lines += &format!("set_prices A={amount}\n");
    }
    lines += "next naive\nget_vars\nchanges\n";
    let program_output = play_with_file_limit(&home, "--days 28", &lines);
    assert_eq!(program_output.exit_code, 1);
    assert!(program_output.stderr.contains("lines had no effect"), "{}", program_output.stderr);
    let objects = program_output.json_lines();
    let refused: Vec<&Value> = objects.iter().filter(|object| object["code"] == "not_saved").collect();
    assert!(refused.len() > 10, "the disk is not full: {}", objects.len());
    assert!(refused.iter().all(|object| {
        object["error"]
            .as_str()
            .is_some_and(|text| text.contains("trajectory.jsonl") && text.contains("safe"))
    }));
    let last = objects.iter().rfind(|object| object["command"] == "set_prices" && object["ok"] == true);
    let accepted = last.expect("an accepted call")["data"]["current"]["A"].as_f64();
    assert_eq!(last_price(&objects), accepted, "memory has exactly what was confirmed");
    let next = objects.iter().find(|object| object["command"] == "next").expect("an answer");
    assert_eq!((next["code"].as_str(), next["day"].as_u64()), (Some("not_saved"), Some(0)));

    let folder = home.only_run();
    let output = home.play(&["--run", &run_id(&folder), "--json"], "changes\nset_prices A=5\nnext naive\n");
    assert_eq!(output.exit_code, 0, "{}", output.stderr);
    let objects = output.json_lines();
    assert_eq!(last_price(&objects), accepted, "the file has exactly what was confirmed");
    assert!(objects.iter().all(|object| object["ok"] != false), "there is space again: {}", output.stdout);
    assert_eq!(home.run(&["replay", &run_id(&folder), "--verify"]).exit_code, 0);
}

#[test]
fn week_without_its_line_is_simulated_again() {
    // A first run measures the lengths of the lines.
    let home = Home::new();
    let start = "set_prices A=12\n".to_owned() + &padding(PADDING);
    home.play(&["--days", "28"], &(start.clone() + "next naive\n"));
    let bytes = read_bytes(&home.only_run(), "trajectory.jsonl");
    let lines = split_lines(&bytes);
    let [before @ .., padded, advance, week, _closed] = &lines[..] else { panic!("there are lines") };
    let frame = padded.len() - PADDING;
    let before = before.concat().len() + padded.len();
    let (advance, week) = (advance.len(), week.len());

    for (room, accepted, remark) in
        [(advance / 2, false, false), (advance + week / 2, true, true), (advance + week + 2000, true, false)]
    {
        let home = Home::new();
        let more = BLOCKS * 512 - before - room - frame;
        let program_output = play_with_file_limit(
            &home,
            "--days 28",
            &(start.clone() + &padding(more) + "next naive\nstatus\n"),
        );
        assert_eq!(program_output.exit_code == 0, accepted, "{}", program_output.stderr);
        let objects = program_output.json_lines();
        let next = objects.iter().find(|object| object["command"] == "next").expect("an answer");
        assert_eq!(next["ok"], accepted, "space for {room} bytes: {next}");
        let has_remark = next["data"]["remark"].as_str().is_some_and(|text| text.contains("simulated again"));
        assert_eq!(has_remark, remark, "space for {room} bytes: {next}");
        let status = objects.iter().find(|object| object["command"] == "status").expect("an answer");
        let folder = home.only_run();
        assert!(trajectory_length(&folder) <= BLOCKS * 512);

        let output = home.play(&["--run", &run_id(&folder), "--json"], "status\n");
        assert_eq!(output.exit_code, 0, "{}", output.stderr);
        let objects = output.json_lines();
        assert_eq!(objects[1]["data"], status["data"], "space for {room} bytes");
        assert_eq!(objects[0]["day"], if accepted { 7 } else { 0 });
        assert_eq!(home.run(&["replay", &run_id(&folder), "--verify"]).exit_code, 0);
    }
}

#[test]
fn full_disk_is_not_reported_as_a_damaged_archive() {
    let (home, other) = (Home::new(), Home::new());
    let run = home.play_two_weeks();
    let archive = home.0.path().join("run.tar.gz").to_string_lossy().into_owned();
    assert_eq!(home.run(&["runs", "export", &run_id(&run), "--out", &archive]).exit_code, 0);
    let program = env!("CARGO_BIN_EXE_novamind");
    let script = format!("trap '' XFSZ; ulimit -f 2; exec '{program}' runs import '{archive}'");
    let full = run_with_input(other.command("sh").args(["-c", &script]), "");
    full.assert_fails(1, &["trajectory.jsonl", "File too large"]);
    assert!(!full.stderr.contains("ask for the archive again"), "{}", full.stderr);
    assert_eq!(fs::read_dir(other.runs()).expect("a folder").count(), 0, "it leaves nothing behind");
    assert_eq!(other.run(&["runs", "import", &archive]).exit_code, 0, "there is space again");
}

#[test]
fn query_rebuilds_only_a_missing_database() {
    let home = Home::new();
    let run = home.play_two_weeks();
    let ask = || home.run(&["query", &run_id(&run), "SELECT count(*), sum(amount) FROM ledger"]);
    let (before, trajectory) = (ask().stdout, read_bytes(&run, "trajectory.jsonl"));
    for snapshot in [true, false] {
        fs::remove_file(run.join("world.db")).expect("gone");
        if !snapshot {
            fs::remove_file(run.join("snapshot.bin")).expect("gone");
        }
        let answer = ask();
        assert_eq!((answer.exit_code, &answer.stdout), (0, &before), "{}", answer.stderr);
        assert!(run.join("world.db").exists(), "the next query finds it");
        assert_eq!(read_bytes(&run, "trajectory.jsonl"), trajectory);
    }
    assert_eq!(ask().stdout, before);
    // If the disk is full, the database is built in memory.
    fs::remove_file(run.join("world.db")).expect("gone");
    let program = env!("CARGO_BIN_EXE_novamind");
    let sql = "SELECT count(*), sum(amount) FROM ledger";
    let script = format!("trap '' XFSZ; ulimit -f 8; exec '{program}' query {} '{sql}'", run_id(&run));
    assert_eq!(run_with_input(home.command("sh").args(["-c", &script]), "").stdout, before);
}

#[test]
fn full_disk_prevents_a_new_run() {
    let home = Home::new();
    let program = env!("CARGO_BIN_EXE_novamind");
    let script = format!("trap '' XFSZ; ulimit -f 0; exec '{program}' play --plain");
    run_with_input(home.command("sh").args(["-c", &script]), "").assert_fails(1, &["runs"]);
    assert_eq!(fs::read_dir(home.runs()).expect("a folder").count(), 0, "it leaves nothing behind");
}
