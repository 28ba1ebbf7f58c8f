//! Plain mode is killed at random times: every action that the program confirmed with `ok` is recorded.
//!
//! A test run has 12 kills, and `.ci/full` has 200. `tests/program/terminal` kills the console.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use novamind::record::trajectory::record::Reversal;
use novamind::record::trajectory::{Line, Record, Trajectory};
use novamind::session::{Access, JournalEntry, Session, read_afterwards, verify};
use serde_json::Value;

use super::random_play::RandomAction;
use super::run::temporary_runs_folder;
use crate::support::company::opening_calls;
use crate::support::dice::Dice;

fn start(runs: &Path, options: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_novamind"));
    command.env("NOVAMIND_RUNS", runs).env("NOVAMIND_CONFIG", runs.join("configuration"));
    command.args(["play", "--plain", "--json"]).args(options);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    command.spawn().expect("the program starts")
}

/// Returns random input for plain mode, about six lines per week.
fn random_script(dice: &mut Dice, weeks: usize, is_new_run: bool) -> String {
    let mut lines = String::new();
    if is_new_run {
        opening_calls().iter().for_each(|(tool, args)| lines += &format!("{tool} {args}\n"));
    }
    for _ in 0..weeks {
        for _ in 0..dice.roll(8) {
            match RandomAction::random(dice, &[3, 4, 5]) {
                RandomAction::Call(tool, args) => lines += &format!("{tool} {args}\n"),
                RandomAction::Undo => lines += "undo\n",
                RandomAction::Query(sql) => lines += &format!("sql {sql}\n"),
                RandomAction::Memo(text) => lines += &format!("memo {text}\n"),
                RandomAction::View(_) => {}
            }
        }
        lines += "next naive\n";
    }
    lines
}

/// Plays for a random time, kills the program, and returns its output up to the kill.
fn play_and_kill(mut child: Child, script: String, dice: &mut Dice) -> Vec<Value> {
    let mut pipe = child.stdin.take().expect("a pipe");
    // The program may end before all input is written.
    let writer = std::thread::spawn(move || drop(pipe.write_all(script.as_bytes())));
    let mut answers = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let mut confirmed = Vec::new();
    let mut read = |confirmed: &mut Vec<Value>| match answers.next() {
        // If the kill truncated the last line, the line confirms no action.
        Some(Ok(line)) => {
            confirmed.extend(serde_json::from_str::<Value>(&line).ok());
            true
        }
        Some(Err(_)) | None => false,
    };
    for _ in 0..dice.roll(60) {
        if !read(&mut confirmed) {
            break;
        }
    }
    let (moment, patience) = (Instant::now(), Duration::from_micros(dice.roll(20_000) as u64));
    while moment.elapsed() < patience {
        std::thread::yield_now();
    }
    child.kill().expect("it is killed");
    while read(&mut confirmed) {}
    child.wait().expect("it ends");
    writer.join().expect("the writer ends");
    confirmed
}

/// Returns the tools of accepted calls and weeks in order, according to the output.
fn confirmed_tools(answers: &[Value]) -> Vec<String> {
    let done = answers.iter().filter(|answer| answer["ok"] == true);
    let words = done.filter_map(|answer| answer["command"].as_str());
    words.filter(|word| !["sql", "memo", "undo"].contains(word)).map(str::to_owned).collect()
}

/// Returns the tools of accepted calls and weeks in order, according to the trajectory, without undo calls.
fn recorded_tools(folder: &Path) -> Vec<String> {
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).expect("it reads");
    let after = read_afterwards(folder, &trajectory).expect("it reads");
    let lines = [trajectory.lines, after.lines].concat();
    let word = |line: &Line| match (&line.record, line.record.accepted_call()) {
        (_, Some((call, _))) if !matches!(call.reversal, Some(Reversal::Undoes(_))) => {
            Some(call.tool.to_string())
        }
        (Record::Advance(_), _) => Some("next".to_owned()),
        _ => None,
    };
    lines.iter().filter_map(word).collect()
}

fn only_run(runs: &Path) -> Option<PathBuf> {
    std::fs::read_dir(runs)
        .ok()?
        .flatten()
        .map(|entry| entry.path())
        .find(|path| path.join("run.toml").exists())
}

fn check_kills(count: usize) {
    let mut dice = Dice::for_test("kills");
    let mut weeks = 0;
    for number in 0..count {
        let place = temporary_runs_folder();
        // A run is killed up to three times. After each kill, all actions confirmed before must be recorded.
        let mut confirmed: Vec<String> = Vec::new();
        for life in 0..1 + dice.roll(3) {
            let exists =
                only_run(place.path()).is_some_and(|folder| folder.join("trajectory.jsonl").exists());
            let seed = number.to_string();
            let options: &[&str] =
                if exists { &["--run", "latest"] } else { &["--seed", &seed, "--days", "140"] };
            let script = random_script(&mut dice, 12, !exists);
            let answers = play_and_kill(start(place.path(), options), script, &mut dice);
            let Some(folder) = only_run(place.path()) else { continue };
            confirmed.extend(confirmed_tools(&answers));
            let recorded = recorded_tools(&folder);
            assert!(
                recorded.len() >= confirmed.len() && recorded[..confirmed.len()] == confirmed,
                "run {number}, life {life}: confirmed {confirmed:?}, recorded {recorded:?}"
            );
            // An action during the kill may be recorded without a confirmation.
            confirmed = recorded;
        }
        let Some(folder) = only_run(place.path()) else { continue };
        let session = Session::open(&folder, Access::Write, true).unwrap_or_else(|error| panic!("{error}"));
        let week_count =
            session.journal().iter().filter(|entry| matches!(entry, JournalEntry::Advance { .. })).count();
        assert_eq!(week_count, confirmed.iter().filter(|word| *word == "next").count(), "run {number}");
        assert_eq!(session.weeks().len(), week_count, "run {number}: a week that was confirmed is complete");
        weeks += week_count;
        drop(session);
        verify(&folder).unwrap_or_else(|error| panic!("run {number}: {error}"));
    }
    println!("{count} runs killed, {weeks} weeks confirmed");
    assert!(weeks > count, "the kills came too early for the test to be meaningful");
}

#[test]
fn confirmed_calls_survive_a_kill() {
    check_kills(12);
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn confirmed_calls_survive_many_kills() {
    check_kills(200);
}
