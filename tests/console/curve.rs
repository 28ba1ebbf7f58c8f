//! The curve explorer: its pictures and dragging; only true values are recorded as inspections.

use std::path::Path;

use novamind::record::mode::Mode;
use novamind::record::trajectory::Record;
use novamind::session::{Goal, Session, lines_afterwards, verify};

use super::harness::Console;
use super::looks::{SIZES, picture};
use super::replay::replayed;
use crate::support::company::{begin_run, open_shop, weeks};
use crate::support::record::{folder_of, looks, recorded};

fn run(runs: &Path, mode: Mode, count: usize) -> Session {
    let mut session = begin_run(runs, mode, 84);
    open_shop(&mut session);
    weeks(&mut session, count);
    session
}

fn in_run(runs: &Path, mode: Mode) -> Console {
    drop(run(runs, mode, 3));
    Console::in_latest_run(runs, SIZES[2])
}

#[test]
fn the_explorer_in_pictures_of_four_sizes() {
    let mut complaints = Vec::new();
    for (mode, name) in [(Mode::Sandbox, "estimates"), (Mode::Debug, "truth")] {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = in_run(runs.path(), mode);
        for (place, keys) in
            [("", "7 v"), ("-dragged", "tab right right right pageup up"), ("-companies", ". . .")]
        {
            console.press(keys);
            insta::assert_snapshot!(format!("curve-{name}{place}"), picture(&mut console, &mut complaints));
        }
    }
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = in_run(runs.path(), Mode::Sandbox);
    console.press("; g / 'participation' enter");
    insta::assert_snapshot!("curve-glossary", picture(&mut console, &mut complaints));
    console.press("enter");
    insta::assert_snapshot!("curve-explained", picture(&mut console, &mut complaints));
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn dragging_sets_nothing_and_leads_to_the_form() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = in_run(runs.path(), Mode::Sandbox);
    console.press("; v");
    console.shows("Participation curve of S1");
    console.shows("estimates of day 0, ±65%");
    console.press("right right down");
    console.shows("A $14");
    console.press("enter");
    console.shows("set_prices");
    console.shows("14");
    drop(console);
    let lines = recorded(&folder_of(runs.path()));
    assert_eq!(looks(&lines), [""; 0], "estimates are not an inspection");
    let calls = lines.lines.iter().filter(|line| matches!(&line.record, Record::Call(_)));
    let days: Vec<u32> = calls.map(|line| line.day).collect();
    assert!(!days.is_empty() && days.iter().all(|day| *day == 0), "{days:?}");
}

#[test]
fn each_look_at_the_truth_is_a_line_and_changes_no_hash() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = in_run(runs.path(), Mode::Debug);
    console.press("7 v");
    console.shows("true values of day 21");
    console.press("right up . esc");
    drop(console);
    let folder = folder_of(runs.path());
    assert_eq!(looks(&recorded(&folder)), ["curve S1 21", "curve S2 21"]);
    assert_eq!(verify(&folder).expect("it verifies").day, 21);
}

#[test]
fn a_replay_shows_the_truth_of_its_moment_once_the_run_is_over() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = run(runs.path(), Mode::Sandbox, 3);
    drop(session.end());
    drop(session);
    let mut console = replayed(runs.path(), SIZES[2], Goal::Week(2));
    console.press("7 v");
    console.shows("true values of day 14");
    drop(console);
    let folder = folder_of(runs.path());
    let after = lines_afterwards(&folder, &recorded(&folder)).expect("lines");
    assert_eq!(looks(&after), ["curve S1 14"]);
}
