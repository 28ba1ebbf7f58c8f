//! Python scripts in the console, which are typed in several lines, stopped by a key, and stopped when the program quits.

use std::process::Command;
use std::time::{Duration, Instant};

use super::pty::Terminal;

fn has_python() -> bool {
    Command::new("python3").args(["-c", ""]).output().is_ok_and(|done| done.status.success())
}

/// Opens the form of python_exec and pastes an endless script.
fn run_endless_script(terminal: &mut Terminal) {
    terminal.type_keys("8");
    terminal.wait_for("set_prices");
    terminal.type_keys("/python_exec\r\r");
    terminal.wait_for("enter edit the code");
    terminal.type_keys("\r");
    terminal.wait_for("code, line 1 of 1");
    terminal.type_keys("\x1b[200~# python\nwhile True:\n    pass\x1b[201~");
    terminal.wait_for("code, line 3 of 3");
    terminal.type_keys("\x13");
    terminal.wait_for("running the script");
}

#[test]
fn script_can_be_stopped_and_does_not_block_quitting() {
    if !has_python() {
        eprintln!("SKIPPED: there is no python3 on the path");
        return;
    }
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new", "--seed", "1"], (100, 30));
    terminal.wait_for("day 0/500");
    run_endless_script(&mut terminal);
    terminal.wait_for("esc stops it");
    terminal.type_keys("\x1b");
    terminal.wait_for("the script was cancelled");
    let begun = Instant::now();
    terminal.type_keys("\x13");
    terminal.wait_for("running the script");
    terminal.signal("-TERM");
    terminal.wait_for_end();
    // A script may take minutes; this limit does not measure speed.
    assert!(begun.elapsed() < Duration::from_secs(100), "the program does not wait for a stopped script");
}
