//! The console is killed at random times: every action that the screen had confirmed is saved.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::{Access, Session, verify};

use super::pty::Terminal;
use crate::support::dice::Dice;

const KILLS: usize = 8;
/// Number of kills in `.ci/full`.
const FULL_TEST_KILLS: usize = 100;

fn only_run(runs: &Path) -> PathBuf {
    let folders = std::fs::read_dir(runs).expect("a folder").flatten().map(|entry| entry.path());
    folders.into_iter().find(|folder| folder.join("run.toml").exists()).expect("a run")
}

/// Returns the number of accepted calls and the number of weeks in the trajectory.
fn recorded_counts(runs: &Path) -> (usize, usize) {
    let lines = Trajectory::read(&only_run(runs).join("trajectory.jsonl")).expect("it reads").lines;
    let calls = lines.iter().filter(|line| line.record.accepted_call().is_some()).count();
    (calls, lines.iter().filter(|line| matches!(line.record, Record::Advance(_))).count())
}

/// Sets a price and waits for its confirmation.
fn set_price(terminal: &mut Terminal, price: usize) {
    terminal.type_keys("8");
    terminal.wait_for("set_prices");
    terminal.type_keys(&format!("\r\r{price}\r"));
    terminal.wait_for("pricing.set_prices");
    terminal.type_keys("\x13");
    terminal.wait_for("set_prices: done");
}

fn start_week(terminal: &mut Terminal) {
    terminal.type_keys("n");
    terminal.wait_for("[1 review]");
    terminal.type_keys("\rbecause\r");
    terminal.wait_for("[3 forecasts]");
    terminal.type_keys("f\r");
}

fn check_kills(count: usize) {
    let mut dice = Dice::for_test("kills in the console");
    for number in 0..count {
        let runs = tempfile::tempdir().expect("a folder");
        let seed = number.to_string();
        let mut terminal = Terminal::start(runs.path(), &["--new", "--seed", &seed], (100, 30));
        terminal.wait_for("day 0/500");
        let (mut calls, mut weeks) = (0, 0);
        set_price(&mut terminal, 10);
        calls += 1;
        for week in 1..=dice.roll(3) {
            start_week(&mut terminal);
            terminal.wait_for(&format!("Week {week} · day"));
            terminal.type_keys("\r");
            weeks += 1;
        }
        // An action is in progress when the program is killed.
        match *dice.pick(&["week", "call"]) {
            "week" => start_week(&mut terminal),
            _ => terminal.type_keys("8\r\r17\r\x13"),
        }
        let (moment, patience) = (Instant::now(), Duration::from_micros(dice.roll(60_000) as u64));
        while moment.elapsed() < patience {
            std::thread::yield_now();
        }
        terminal.signal("-KILL");
        terminal.wait_for_killed();
        let (kept_calls, kept_weeks) = recorded_counts(runs.path());
        assert!(
            kept_calls >= calls && kept_weeks >= weeks,
            "kill {number}: {kept_calls} calls, {kept_weeks} weeks"
        );
        let folder = only_run(runs.path());
        let session = Session::open(&folder, Access::Write, true).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(session.weeks().len(), kept_weeks, "kill {number}");
        drop(session);
        verify(&folder).unwrap_or_else(|error| panic!("kill {number}: {error}"));
        let mut terminal = Terminal::start(runs.path(), &["--run", "latest"], (100, 30));
        terminal.wait_for(&format!("day {}/500", 7 * kept_weeks));
        terminal.type_keys("\x03");
        terminal.wait_for_end();
    }
}

#[test]
fn confirmed_changes_survive_a_kill() {
    check_kills(KILLS);
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn confirmed_changes_survive_every_kill() {
    check_kills(FULL_TEST_KILLS);
}
