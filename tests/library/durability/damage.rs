//! Truncated files and changed bytes: damage is always detected, and all recoverable data is recovered.
//!
//! Every test run tries a few positions, and `.ci/full` tries 2,000.

use std::fs;
use std::path::{Path, PathBuf};

use novamind::record::trajectory::record::Outcome;
use novamind::record::trajectory::{Line, Record, Trajectory};
use novamind::session::{Access, Session};
use serde_json::Value;

use super::random_play::{advance_week, apply_random_actions};
use super::run::{copy_run, create_run, open_run, session_view, temporary_runs_folder};
use crate::support::company::apply_opening_decisions;
use crate::support::dice::Dice;

/// Plays a run of several weeks with decisions in the current week, and closes it properly. Returns its folder and its
/// visible state.
fn closed_run(place: &Path) -> (PathBuf, Value) {
    let mut session = create_run(place, 21, 60);
    let folder = session.folder().expect("a folder").to_owned();
    let mut dice = Dice::new(4);
    apply_opening_decisions(&mut session);
    for _ in 0..5 {
        apply_random_actions(&mut session, &mut dice);
        advance_week(&mut session);
    }
    session.set_notes("weeks 1 to 5: prices first").expect("kept");
    apply_random_actions(&mut session, &mut dice);
    session.save().expect("saved");
    let view = session_view(&mut session);
    (folder, view)
}

/// Changes a random byte of a file, or truncates the file at this byte.
fn damage_file(file: &Path, dice: &mut Dice) -> (usize, bool) {
    let mut bytes = fs::read(file).expect("bytes");
    let (at, cut) = (dice.roll(bytes.len()), dice.roll(2) == 0);
    if cut {
        bytes.truncate(at);
    } else {
        bytes[at] ^= 1 << dice.roll(8);
    }
    fs::write(file, bytes).expect("written");
    (at, cut)
}

fn check_damage_to_derived_files(places: usize) {
    let (runs_folder, other) = (temporary_runs_folder(), temporary_runs_folder());
    let (folder, expected) = closed_run(runs_folder.path());
    let mut dice = Dice::for_test("damage beside the trajectory");
    for number in 0..places {
        let name = *dice.pick(&["world.db", "snapshot.bin", "memo.md"]);
        let place = copy_run(&folder, &other.path().join(number.to_string()));
        let (at, cut) = damage_file(&place.join(name), &mut dice);
        let mut session = open_run(&place);
        assert_eq!(session_view(&mut session), expected, "{name}, byte {at}, cut {cut}");
        assert!(!session.remarks().is_empty(), "{name}, byte {at}, cut {cut}: no message");
        drop(session);
        fs::remove_dir_all(place).expect("gone");
    }
}

fn check_damage_to_the_trajectory(places: usize) {
    let (runs_folder, other) = (temporary_runs_folder(), temporary_runs_folder());
    let (folder, expected) = closed_run(runs_folder.path());
    let whole = fs::read(folder.join("trajectory.jsonl")).expect("bytes");
    let lines = Trajectory::parse(&whole).expect("lines").lines.len();
    let mut dice = Dice::for_test("damage in the trajectory");
    let (mut refused, mut dropped) = (0, 0);
    for number in 0..places {
        let place = copy_run(&folder, &other.path().join(number.to_string()));
        let path = place.join("trajectory.jsonl");
        let (at, cut) = damage_file(&path, &mut dice);
        let damaged_bytes = fs::read(&path).expect("bytes");
        match Session::open(&place, Access::Write, true) {
            // Only a last line without a line end may be dropped.
            Ok(mut session) => {
                assert!(
                    at >= whole[..whole.len() - 1].iter().rposition(|b| *b == b'\n').expect("a line end")
                );
                let is_reported = session.remarks().iter().any(|text| text.contains("unfinished"));
                assert!(is_reported, "byte {at}, cut {cut}");
                let value = session_view(&mut session);
                assert_eq!(value["weeks"], expected["weeks"], "byte {at}, cut {cut}");
                dropped += 1;
            }
            Err(error) => {
                let text = error.to_string();
                assert!(
                    text.contains("trajectory.jsonl") && text.contains("line"),
                    "byte {at}, cut {cut}: {text}"
                );
                assert_eq!(
                    fs::read(&path).expect("bytes"),
                    damaged_bytes,
                    "a failed opening changes nothing"
                );
                // Opening the run read-only also fails.
                assert!(Session::open(&place, Access::Read, false).is_err(), "byte {at}, cut {cut}");
                refused += 1;
            }
        }
        fs::remove_dir_all(place).expect("gone");
    }
    println!("{lines} lines, {refused} refused, {dropped} with a dropped last line");
    assert!(refused > dropped);
}

#[test]
fn damage_to_derived_files_is_repaired() {
    check_damage_to_derived_files(50);
}

#[test]
fn damage_to_the_trajectory_is_reported() {
    check_damage_to_the_trajectory(50);
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn random_damage_is_detected_or_repaired() {
    check_damage_to_derived_files(1000);
    check_damage_to_the_trajectory(1000);
}

/// The checksum protects the last line: every changed byte is detected, even without the database and the snapshot.
#[test]
fn every_byte_of_the_last_line_is_verified() {
    let (runs_folder, other) = (temporary_runs_folder(), temporary_runs_folder());
    let (folder, _) = closed_run(runs_folder.path());
    let place = copy_run(&folder, other.path());
    ["world.db", "snapshot.bin"].iter().for_each(|name| fs::remove_file(place.join(name)).expect("gone"));
    let path = place.join("trajectory.jsonl");
    let whole = fs::read(&path).expect("bytes");
    let last = whole[..whole.len() - 1].iter().rposition(|byte| *byte == b'\n').expect("a line end") + 1;
    for at in last..whole.len() - 1 {
        let mut changed = whole.clone();
        changed[at] ^= 2;
        assert!(Trajectory::parse(&changed).is_err(), "byte {at}");
    }
}

/// Missing lines at the end are detected as long as the database or the snapshot exists.
#[test]
fn missing_last_lines_are_detected() {
    let (runs_folder, other) = (temporary_runs_folder(), temporary_runs_folder());
    let (folder, _) = closed_run(runs_folder.path());
    let whole = fs::read(folder.join("trajectory.jsonl")).expect("bytes");
    let ends: Vec<usize> = (0..whole.len()).filter(|at| whole[*at] == b'\n').map(|at| at + 1).collect();
    for (number, end) in ends[1..ends.len() - 1].iter().enumerate() {
        let place = copy_run(&folder, &other.path().join(number.to_string()));
        fs::remove_file(place.join(["world.db", "snapshot.bin"][number % 2])).expect("gone");
        fs::write(place.join("trajectory.jsonl"), &whole[..*end]).expect("written");
        let lines = Trajectory::parse(&whole[..*end]).expect("lines").lines;
        let error = match Session::open(&place, Access::Write, true) {
            Err(error) => error.to_string(),
            // The database stores the position of the last call or week. Later views and queries do not change this position.
            Ok(_) => {
                let rest = Trajectory::parse(&whole).expect("lines").lines.split_off(lines.len());
                let idle = |line: &Line| match &line.record {
                    Record::Query(_) | Record::Activity(_) | Record::Memo(_) | Record::Note(_) => true,
                    Record::Call(call) => matches!(call.outcome, Outcome::Rejected(_)),
                    _ => false,
                };
                assert!(number % 2 == 1 && rest.iter().all(idle));
                continue;
            }
        };
        assert!(error.contains(&format!("line {}", lines.len() + 1)), "{error}");
        assert!(error.contains("missing") && error.contains("recover"), "{error}");
    }
}
