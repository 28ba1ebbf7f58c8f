//! A run that is closed and opened again equals an uninterrupted run.

use std::fs;

use novamind::session::{Access, Session, verify};

use super::random_play::{advance_week, apply_random_action, apply_random_actions};
use super::run::{copy_run, create_run, open_run, session_view, temporary_runs_folder};
use crate::support::company::apply_opening_decisions;
use crate::support::dice::Dice;

/// At every week and between its decisions, a reopened run equals the uninterrupted run and continues identically.
#[test]
fn snapshot_restores_the_complete_state() {
    let (runs_folder, other) = (temporary_runs_folder(), temporary_runs_folder());
    let mut uninterrupted_session = create_run(runs_folder.path(), 11, 120);
    let folder = uninterrupted_session.folder().expect("a folder").to_owned();
    let mut dice = Dice::for_test("snapshots");
    apply_opening_decisions(&mut uninterrupted_session);
    for number in 0..14 {
        apply_random_actions(&mut uninterrupted_session, &mut dice);
        uninterrupted_session.save().expect("saved");
        let again = copy_run(&folder, &other.path().join(number.to_string()));
        // A snapshot can only be used with an up-to-date database.
        assert!(again.join("snapshot.bin").exists());
        let mut resumed = open_run(&again);
        assert_eq!(resumed.remarks(), [""; 0], "week {number}");
        assert_eq!(session_view(&mut resumed), session_view(&mut uninterrupted_session), "week {number}");
        // Undo also reverts actions from before the run was closed.
        let seed = dice.roll(1 << 20) as u64;
        let continue_run = |session: &mut Session| {
            let mut dice = Dice::new(seed);
            let _ = session.undo(novamind::record::trajectory::record::Via::Form);
            (0..2).for_each(|_| apply_random_action(session, &mut dice));
            advance_week(session);
        };
        continue_run(&mut uninterrupted_session);
        continue_run(&mut resumed);
        let (mut left, mut right) = (session_view(&mut resumed), session_view(&mut uninterrupted_session));
        // The recorded times of submission differ, so they are replaced before the comparison.
        for view in [&mut left, &mut right] {
            view["rows"][4] = "submitted at".into();
        }
        assert_eq!(left, right, "after week {number}");
    }
    let day = uninterrupted_session.day();
    assert!(day >= 35, "the company went bankrupt too early for the test to be meaningful: day {day}");
    drop(uninterrupted_session);
    assert_eq!(verify(&folder).expect("it verifies").day, day);
}

#[test]
fn unusable_snapshots_are_replaced_by_replay() {
    let (runs_folder, other) = (temporary_runs_folder(), temporary_runs_folder());
    let mut session = create_run(runs_folder.path(), 5, 60);
    let folder = session.folder().expect("a folder").to_owned();
    apply_opening_decisions(&mut session);
    advance_week(&mut session);
    session.save().expect("saved");
    let early = fs::read(folder.join("snapshot.bin")).expect("a snapshot");
    (0..2).for_each(|_| advance_week(&mut session));
    session.save().expect("saved");
    let expected = session_view(&mut session);
    drop(session);
    let late = fs::read(folder.join("snapshot.bin")).expect("a snapshot");
    let mut foreign = create_run(other.path(), 6, 60);
    apply_opening_decisions(&mut foreign);
    foreign.save().expect("saved");
    let foreign = fs::read(foreign.folder().expect("a folder").join("snapshot.bin")).expect("a snapshot");

    let mut changed = late.clone();
    *changed.last_mut().expect("bytes") ^= 1;
    let mut later_format = late.clone();
    later_format[18] = b'9';
    for (name, bytes, text) in [
        ("none", None, None),
        ("an earlier one", Some(early), None),
        ("one of another run", Some(foreign), Some("another run")),
        ("a damaged one", Some(changed), Some("is damaged")),
        ("half of one", Some(late[..late.len() / 2].to_vec()), Some("is damaged")),
        ("almost nothing", Some(late[..30].to_vec()), Some("is truncated")),
        ("an empty one", Some(Vec::new()), Some("another version or is damaged")),
        ("one of another format", Some(later_format), Some("another version or is damaged")),
    ] {
        let place = copy_run(&folder, &other.path().join(name));
        match bytes {
            Some(bytes) => fs::write(place.join("snapshot.bin"), bytes).expect("written"),
            None => fs::remove_file(place.join("snapshot.bin")).expect("gone"),
        }
        let mut session = open_run(&place);
        assert_eq!(session_view(&mut session), expected, "{name}");
        let remarks = session.remarks().join(" ");
        assert_eq!(text.is_some(), !remarks.is_empty(), "{name}: {remarks}");
        assert!(remarks.contains(text.unwrap_or_default()), "{name}: {remarks}");
        advance_week(&mut session);
        session.save().expect("saved");
        drop(session);
        let mut session = open_run(&place);
        assert_eq!(session.remarks(), [""; 0], "{name}: the new snapshot is good");
        assert_eq!(session_view(&mut session)["observation"]["day"], 28);
    }
}

/// Reading a run requires only its trajectory and changes no file.
#[test]
fn reading_a_run_changes_no_files() {
    let runs_folder = temporary_runs_folder();
    let mut session = create_run(runs_folder.path(), 3, 60);
    let folder = session.folder().expect("a folder").to_owned();
    apply_opening_decisions(&mut session);
    advance_week(&mut session);
    session.save().expect("saved");
    let expected = session_view(&mut session);
    drop(session);
    let files = |name: &str| fs::read(folder.join(name)).expect("bytes");
    let before = ["snapshot.bin", "trajectory.jsonl", "run.toml", "world.db"].map(files);
    let mut reader = Session::open(&folder, Access::Read, true).expect("it opens");
    assert_eq!(session_view(&mut reader), expected);
    reader.save().expect("nothing to save");
    drop(reader);
    assert_eq!(["snapshot.bin", "trajectory.jsonl", "run.toml", "world.db"].map(files), before);
}
