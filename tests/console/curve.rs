//! The curve explorer: snapshots and dragging with the mouse. Only true values are recorded as inspections.

use std::path::Path;

use novamind::record::mode::Mode;
use novamind::record::trajectory::Record;
use novamind::session::{SeekTarget, Session, read_afterwards, verify};

use super::harness::Console;
use super::picture_checks::{SIZES, snapshot_text};
use super::replay::console_in_replay;
use crate::support::company::{advance_weeks, apply_opening_decisions, begin_run};
use crate::support::record::{inspections, read_trajectory, run_folder};

fn create_run(runs: &Path, mode: Mode, count: usize) -> Session {
    let mut session = begin_run(runs, mode, 84);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, count);
    session
}

fn console_in_run(runs: &Path, mode: Mode) -> Console {
    drop(create_run(runs, mode, 3));
    Console::in_latest_run(runs, SIZES[2])
}

#[test]
fn curve_explorer_matches_snapshots() {
    let mut complaints = Vec::new();
    for (mode, name) in [(Mode::Sandbox, "estimates"), (Mode::Debug, "truth")] {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = console_in_run(runs.path(), mode);
        for (place, keys) in
            [("", "7 v"), ("-dragged", "tab right right right pageup up"), ("-companies", ". . .")]
        {
            console.press(keys);
            insta::assert_snapshot!(
                format!("curve-{name}{place}"),
                snapshot_text(&mut console, &mut complaints)
            );
        }
    }
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_run(runs.path(), Mode::Sandbox);
    console.press("; g / 'participation' enter");
    insta::assert_snapshot!("curve-glossary", snapshot_text(&mut console, &mut complaints));
    console.press("enter");
    insta::assert_snapshot!("curve-explained", snapshot_text(&mut console, &mut complaints));
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn dragging_a_point_opens_the_form_without_a_change() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_run(runs.path(), Mode::Sandbox);
    console.press("; v");
    console.assert_shows("Participation curve of S1");
    console.assert_shows("estimates of day 0 · each within 65% of its true value");
    console.press("right right down");
    console.assert_shows("A $14");
    console.press("enter");
    console.assert_shows("set_prices");
    console.assert_shows("14");
    drop(console);
    let lines = read_trajectory(&run_folder(runs.path()));
    assert_eq!(inspections(&lines), [""; 0], "estimates are not an inspection");
    let calls = lines.lines.iter().filter(|line| matches!(&line.record, Record::Call(_)));
    let days: Vec<u32> = calls.map(|line| line.day).collect();
    assert!(!days.is_empty() && days.iter().all(|day| *day == 0), "{days:?}");
}

#[test]
fn each_inspection_of_a_true_curve_is_recorded() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_run(runs.path(), Mode::Debug);
    console.press("7 v");
    console.assert_shows("true values of day 21");
    console.press("right up . esc");
    drop(console);
    let folder = run_folder(runs.path());
    assert_eq!(inspections(&read_trajectory(&folder)), ["curve S1 21", "curve S2 21"]);
    assert_eq!(verify(&folder).expect("it verifies").day, 21);
}

#[test]
fn replay_shows_the_true_curve_of_a_finished_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = create_run(runs.path(), Mode::Sandbox, 3);
    drop(session.abandon());
    drop(session);
    let mut console = console_in_replay(runs.path(), SIZES[2], SeekTarget::Week(2));
    console.press("7 v");
    console.assert_shows("true values of day 14");
    drop(console);
    let folder = run_folder(runs.path());
    let after = read_afterwards(&folder, &read_trajectory(&folder)).expect("lines");
    assert_eq!(inspections(&after), ["curve S1 14"]);
}
