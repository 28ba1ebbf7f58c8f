//! An adopted branch is complete or absent: killed programs and full disks.

use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::support::company::opening_calls;
use crate::support::home::{Home, ProgramOutput, read_bytes, run_id, run_with_input};

/// Plays a debug run with a number of calls in each week, and returns its folder.
fn debug_run(home: &Home, weeks: usize, calls: usize) -> PathBuf {
    let mut lines: String = opening_calls().iter().map(|(tool, args)| format!("{tool} {args}\n")).collect();
    lines += &("set_prices A=13\nset_prices A=12\n".repeat(calls / 2) + "next naive\n").repeat(weeks);
    assert_eq!(home.play(&["--mode", "debug", "--seed", "3"], &lines).exit_code, 0);
    home.only_run()
}

/// Returns staging folders of incomplete branches.
fn staging_folders(home: &Home) -> Vec<PathBuf> {
    let entries = fs::read_dir(home.runs()).expect("a folder").flatten().map(|entry| entry.path());
    entries
        .filter(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.')))
        .collect()
}

fn listed_runs(home: &Home) -> Vec<Value> {
    let program_output = home.run(&["runs", "list", "--json"]);
    let list: Value = serde_json::from_str(&program_output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", program_output.stdout));
    list.as_array().or(list["runs"].as_array()).expect("a list").clone()
}

#[test]
fn killed_adoption_leaves_no_run() {
    let home = Home::new();
    let run = debug_run(&home, 15, 0);
    let mut child = home
        .program()
        .args(["play", "--plain", "--json", "--run", &run_id(&run)])
        .spawn()
        .expect("it starts");
    let mut pipe = child.stdin.take().expect("a pipe");
    pipe.write_all(b"whatif adopt from 2: set_prices * 0.9\n").expect("written");
    let begun = Instant::now();
    // The first weeks of the branch are on disk, and the branch is incomplete.
    let is_under_way = || {
        let trajectory = staging_folders(&home).first().map(|folder| folder.join("trajectory.jsonl"));
        trajectory
            .and_then(|path| fs::read_to_string(path).ok())
            .is_some_and(|text| text.matches("\"kind\":\"week\"").count() > 2)
    };
    while !is_under_way() {
        assert!(begun.elapsed() < Duration::from_secs(60), "the branch never began");
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().expect("killed");
    child.wait().expect("it ends");
    assert_eq!(staging_folders(&home).len(), 1, "it was killed on the way");
    assert_eq!(listed_runs(&home).len(), 1, "an incomplete branch is not a run");
    let program_output =
        home.play(&["--run", &run_id(&run), "--json"], "whatif adopt from 2: set_prices * 0.9\nstatus\n");
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    assert_eq!((staging_folders(&home), listed_runs(&home).len()), (Vec::new(), 2));
    assert_eq!(program_output.json_lines().last().expect("an answer")["day"], 105);
    let branch =
        listed_runs(&home).iter().find(|value| value["id"] != run_id(&run)).expect("the branch")["id"]
            .clone();
    assert_eq!(home.run(&["replay", branch.as_str().expect("an id"), "--verify"]).exit_code, 0);
}

#[test]
fn full_disk_prevents_adoption_and_keeps_the_run() {
    let home = Home::new();
    let run = debug_run(&home, 12, 400);
    let blocks = read_bytes(&run, "trajectory.jsonl").len() * 3 / 4 / 512;
    let program = env!("CARGO_BIN_EXE_novamind");
    let script = format!("ulimit -f {blocks}; exec '{program}' play --plain --json --run {}", run_id(&run));
    let ProgramOutput { stdout: out, stderr: err, exit_code: code } = run_with_input(
        home.command("sh").args(["-c", &script]),
        "whatif adopt from 2: set_prices * 0.9\nstatus\n",
    );
    assert_eq!(code, 1, "{err}{out}");
    let answers: Vec<Value> = out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let adopted = answers.iter().find(|answer| answer["command"] == "branch").expect("an answer");
    assert_eq!(
        (&adopted["ok"], &adopted["code"]),
        (&Value::Bool(false), &Value::from("not_saved")),
        "{adopted}"
    );
    assert!(
        adopted["error"].as_str().is_some_and(|words| words.contains("no branch was created")),
        "{adopted}"
    );
    assert_eq!(answers.last().expect("an answer")["day"], 84, "the run continues");
    assert_eq!((staging_folders(&home), listed_runs(&home).len()), (Vec::new(), 1));
    assert_eq!(home.run(&["replay", &run_id(&run), "--verify"]).exit_code, 0);
}
