//! Tests of playback: every seek reaches the recorded state, and files on the disk do not change.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde_json::json;

use super::record_view::RecordView;
use crate::create::{NewRun, Storage};
use crate::figures::week::Forecasts;
use crate::playback::*;
use crate::resume::verify::verify;
use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::{Call, Outcome, Via};
use novamind_record::trajectory::{Durability, Record};

pub(crate) struct RecordedRun {
    _runs: tempfile::TempDir,
    pub folder: PathBuf,
    pub id: String,
}

/// Records and closes a run with calls, a rejection, a query, notes and a screen view.
pub(crate) fn record_run(mode: Mode, weeks: u32) -> RecordedRun {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_weeks(runs.path(), mode, weeks);
    let (folder, id) = (session.folder().expect("a folder").to_owned(), session.manifest().id.clone());
    drop(session);
    RecordedRun { _runs: runs, folder, id }
}

fn play_weeks(runs: &Path, mode: Mode, weeks: u32) -> Session {
    let new = NewRun {
        seed: Some(7),
        days: Some(35),
        mode,
        storage: Storage::Runs(runs.to_owned()),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    session.call("set_prices", &json!({"A": 12, "B": 25, "C": 55}), Via::Form).expect("prices");
    let quotas = json!({"A": 60_000, "B": 250_000, "C": 1_200_000});
    session.call("set_usage_quotas", &quotas, Via::Form).expect("quotas");
    session.call("set_prices", &json!({"A": -1}), Via::Form).expect_err("a price below zero");
    let ads = json!({"targeted_spend": {"content_marketing": {"S1": 750}}});
    session.call("set_targeted_ad_spend", &ads, Via::Form).expect("ads");
    for week in 0..weeks {
        let forecasts = session.company().naive_forecasts();
        session.advance("if it holds", &forecasts, Via::Form, &mut |_| {}).expect("a week");
        if week + 1 < weeks {
            session
                .call("set_daily_spend", &json!({"operations": 10 * week, "development": 5}), Via::Form)
                .expect("spend");
            session.query("SELECT count(*) FROM customers").expect("an answer");
            session.set_notes("remember the ads").expect("notes");
            session.activity().record_view("cash", "overview", 1_500);
        }
    }
    session
}

fn read_files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    entries.map(|path| (path.clone(), std::fs::read(path).expect("a file"))).collect()
}

fn seek(playback: &mut Playback, goal: SeekTarget) -> SeekResult {
    playback.seek(goal, &mut |_| ControlFlow::Continue(())).expect("the seek succeeds")
}

fn recorded_hashes(folder: &Path) -> BTreeMap<u32, String> {
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).expect("a trajectory");
    let hash = |line: &Line| Some((line.day, line.record.closed_days()?.state_hash.clone()));
    trajectory.lines.iter().filter_map(hash).collect()
}

#[test]
fn every_seek_reaches_the_recorded_state() {
    let run = record_run(Mode::Sandbox, 5);
    let before = read_files(&run.folder);
    let recorded = recorded_hashes(&run.folder);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    assert_eq!((playback.position().day, playback.position().week, playback.position().weeks), (0, 0, 5));
    let check = |playback: &mut Playback, week: u32| {
        assert_eq!(playback.session().day(), 7 * week);
        assert_eq!(playback.position().week, week);
        assert_eq!(playback.session().state_hash().0, recorded[&(7 * week)], "week {week}");
        let days = playback.session_mut().query("SELECT max(day) FROM ledger").expect("an answer");
        assert_eq!(days.rows[0][0], novamind_database::Cell::Integer(i64::from(7 * week)), "the database");
    };
    for week in 1..=5 {
        assert_eq!(seek(&mut playback, SeekTarget::Weeks(1)), SeekResult::Reached);
        check(&mut playback, week);
    }
    assert_eq!(
        playback.session().ended(),
        Some(novamind_record::trajectory::record::RunEndReason::Horizon),
        "the end of the run belongs to its last week"
    );
    assert!(playback.is_at_end());
    for week in [4, 3] {
        assert_eq!(seek(&mut playback, SeekTarget::Weeks(-1)), SeekResult::ReachedInNewSession);
        check(&mut playback, week);
    }
    for week in [1, 5, 2, 4] {
        seek(&mut playback, SeekTarget::Week(week));
        check(&mut playback, week);
    }
    seek(&mut playback, SeekTarget::Weeks(-100));
    assert_eq!((playback.session().day(), playback.position().line), (0, 1));
    seek(&mut playback, SeekTarget::Weeks(3));
    check(&mut playback, 3);
    seek(&mut playback, SeekTarget::Last);
    check(&mut playback, 5);
    seek(&mut playback, SeekTarget::Week(99));
    check(&mut playback, 5);
    seek(&mut playback, SeekTarget::First);
    assert_eq!(playback.position().line, 1);
    drop(playback);
    assert_eq!(read_files(&run.folder), before, "a file changed");
}

#[test]
fn line_steps_show_states_between_weeks() {
    let run = record_run(Mode::Sandbox, 2);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    let price =
        |playback: &Playback| playback.session().company().current_arguments("set_prices")["A"].as_f64();
    assert_eq!(price(&playback), Some(0.0));
    seek(&mut playback, SeekTarget::Lines(1));
    assert_eq!(price(&playback), Some(12.0));
    let chapter = playback.position().chapter;
    assert_eq!((chapter.week, chapter.day, chapter.applied_entries, chapter.entries.len()), (1, 0, 1, 6));
    assert!(
        matches!(&chapter.entries[2].record, Record::Call(Call { tool, outcome: Outcome::Rejected(_), .. }) if *tool == novamind_tools::ToolId::SetPrices)
    );
    seek(&mut playback, SeekTarget::Lines(-1));
    assert_eq!(price(&playback), Some(0.0));
    seek(&mut playback, SeekTarget::Lines(5));
    assert!(matches!(playback.position().chapter.entries[4].record, Record::Advance(_)));
    assert_eq!(playback.session().day(), 0, "the week is submitted, but not simulated");
    seek(&mut playback, SeekTarget::Lines(1));
    assert_eq!((playback.session().day(), playback.position().chapter.applied_entries), (7, 0));
}

#[test]
fn position_marks_future_outcomes() {
    let run = record_run(Mode::Sandbox, 5);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    let foreseen = |playback: &Playback| {
        let chapter = playback.position().chapter;
        let filed = |entry: &RecordView| matches!(entry.record, Record::Advance(_));
        chapter.entries.into_iter().find(filed).expect("a submitted week")
    };
    let entry = foreseen(&playback);
    let early = &entry.forecasts;
    assert!(early.iter().all(|forecast| entry.is_future(forecast)));
    assert!(early[0].outcome.is_some() && early[1].outcome.is_some(), "days 7 and 28 were recorded");
    assert_eq!(early[2].outcome, None, "day 84 was not recorded");
    seek(&mut playback, SeekTarget::Last);
    let entry = foreseen(&playback);
    let late = entry.forecasts[0];
    assert_eq!((late.due_day(), entry.is_future(&late)), (35, false), "the last chapter stays at the end");
    assert_eq!(late.outcome, playback.session().cash_by_day().last().copied());
}

#[test]
fn playback_shows_notes_only_after_they_were_written() {
    let run = record_run(Mode::Sandbox, 3);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    assert_eq!(playback.notes(), None);
    seek(&mut playback, SeekTarget::Last);
    assert_eq!(playback.notes().as_deref(), Some("remember the ads"));
}

#[test]
fn playback_is_read_only_and_seeks_can_be_stopped() {
    let run = record_run(Mode::Sandbox, 4);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    let rejection =
        playback.session_mut().call("set_prices", &json!({"A": 1}), Via::Form).expect_err("read-only");
    assert_eq!(rejection.code, "read_only");
    let mut days = Vec::new();
    let stopped = playback.seek(SeekTarget::Last, &mut |day| {
        days.push(day);
        if day < 14 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    assert_eq!((stopped.expect("no problem"), playback.session().day()), (SeekResult::Stopped, 14));
    assert_eq!(days, [7, 14]);
    seek(&mut playback, SeekTarget::Last);
    let back = playback.seek(SeekTarget::Week(2), &mut |_| ControlFlow::Break(())).expect("no problem");
    assert_eq!(
        (back, playback.session().day()),
        (SeekResult::Stopped, 28),
        "a backward seek is all or nothing"
    );
}

#[test]
fn create_branch_copies_everything_up_to_the_position() {
    let run = record_run(Mode::Sandbox, 5);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    seek(&mut playback, SeekTarget::Week(2));
    seek(&mut playback, SeekTarget::Lines(1));
    let mut branch = playback.create_branch(Mode::Debug).expect("a branch");
    assert_eq!((branch.day(), branch.manifest().mode), (14, Mode::Debug));
    assert_eq!(
        branch.company().current_arguments("set_daily_spend")["operations"],
        10.0,
        "the branch includes this week's first call"
    );
    assert_eq!(branch.manifest().parent.as_ref().map(|parent| parent.run.as_str()), Some(run.id.as_str()));
    let forecasts = branch.company().naive_forecasts();
    branch.advance("otherwise", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    let folder = branch.folder().expect("a folder").to_owned();
    drop(branch);
    assert_eq!(verify(&folder).expect("an intact run").day, 21);
    // A week that was submitted but not simulated is not part of the branch.
    seek(&mut playback, SeekTarget::First);
    seek(&mut playback, SeekTarget::Lines(5));
    assert_eq!(playback.create_branch(Mode::Sandbox).expect("a branch").day(), 0);
    assert_eq!(playback.create_branch(Mode::Baseline).err().expect("no baseline").code, "not_in_this_mode");
    seek(&mut playback, SeekTarget::Last);
    assert_eq!(playback.create_branch(Mode::Sandbox).err().expect("it is over").code, "run_over");
}

#[test]
fn unfinished_baseline_run_cannot_be_branched() {
    let run = record_run(Mode::Baseline, 2);
    let playback = Playback::open(&run.folder).expect("it opens");
    assert!(playback.position().branch_rejection.expect("a reason").contains("end it first"));
    assert_eq!(playback.create_branch(Mode::Sandbox).err().expect("refused").code, "not_in_this_mode");
    crate::play::open::abandon_run(run.folder.parent().expect("the runs"), &run.id).expect("it ends");
    let playback = Playback::open(&run.folder).expect("it opens");
    assert_eq!(playback.create_branch(Mode::Sandbox).expect("a branch").day(), 0);
}

#[test]
fn standalone_trajectory_can_be_played() {
    let run = record_run(Mode::Sandbox, 3);
    let elsewhere = tempfile::tempdir().expect("a folder");
    let file = elsewhere.path().join("of a participant.jsonl");
    std::fs::copy(run.folder.join("trajectory.jsonl"), &file).expect("copied");
    let mut playback = Playback::open(&file).expect("it opens");
    seek(&mut playback, SeekTarget::Last);
    assert_eq!(playback.session().state_hash().0, recorded_hashes(&run.folder)[&21]);
    let verified = verify(&file).expect("it verifies");
    assert_eq!(verified, verify(&run.folder).expect("the run verifies"));
    assert_eq!((verified.day, verified.states), (21, 3));
    assert_eq!(playback.create_branch(Mode::Sandbox).err().expect("refused").code, "not_possible");
    let problem =
        Playback::open(&elsewhere.path().join("none.jsonl")).err().expect("the file does not exist");
    assert!(problem.to_string().contains("none.jsonl"), "{problem}");
}

#[test]
fn playback_follows_a_running_session() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut played = play_weeks(runs.path(), Mode::Sandbox, 2);
    let folder = played.folder().expect("a folder").to_owned();
    let mut playback = Playback::open(&folder).expect("it opens while the run is being written");
    playback.start_following();
    seek(&mut playback, SeekTarget::Last);
    assert_eq!(playback.session().day(), 14);
    assert!(!playback.poll_new_lines().expect("no problem"), "nothing has happened");
    played.call("set_prices", &json!({"A": 15}), Via::Form).expect("a price");
    assert!(playback.poll_new_lines().expect("no problem"));
    seek(&mut playback, SeekTarget::Last);
    assert_eq!(playback.session().company().current_arguments("set_prices")["A"], 15.0);
    // A partial line is ignored.
    let path = folder.join("trajectory.jsonl");
    let whole = std::fs::read(&path).expect("a trajectory");
    let forecasts: Forecasts = played.company().naive_forecasts();
    played.advance("continue", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    let after = std::fs::read(&path).expect("a trajectory");
    drop(played);
    std::fs::write(&path, &after[..whole.len() + 40]).expect("a part of a line");
    assert!(!playback.poll_new_lines().expect("no problem"));
    std::fs::write(&path, &after).expect("the rest");
    assert!(playback.poll_new_lines().expect("no problem"));
    seek(&mut playback, SeekTarget::Last);
    assert_eq!(playback.session().state_hash().0, recorded_hashes(&folder)[&21]);
    std::fs::write(&path, &after[..60]).expect("a shorter file");
    assert!(
        playback.poll_new_lines().expect_err("lines are gone").to_string().contains("lines were removed")
    );
}

#[test]
fn playback_stops_before_a_state_that_does_not_reproduce() {
    let run = record_run(Mode::Sandbox, 4);
    let path = run.folder.join("trajectory.jsonl");
    // Write a trajectory with a changed call and a valid hash chain.
    let read = Trajectory::read(&path).expect("a trajectory");
    let mut lines = read.lines.clone();
    let last_call = lines.iter_mut().rev().find_map(|line| match &mut line.record {
        Record::Call(call) => Some(call),
        _ => None,
    });
    let call = last_call.expect("a call");
    call.args = json!({"operations": 77, "development": 5});
    call.outcome = Outcome::Accepted(json!({"operations": 77.0, "development": 5.0}));
    let copy = run.folder.with_file_name("other.jsonl");
    let mut writer = novamind_record::trajectory::TrajectoryWriter::create(&copy).expect("a file");
    for line in &lines {
        writer.append(line.day, &line.record, Durability::Written).expect("a line");
    }
    let mut playback = Playback::open(&copy).expect("the hash chain is valid");
    let problem =
        playback.seek(SeekTarget::Last, &mut |_| ControlFlow::Continue(())).expect_err("another state");
    assert!(problem.to_string().contains("line"), "{problem}");
    let reached = playback.session().day();
    assert!(reached == 21, "{reached}");
    assert_eq!(playback.session().state_hash().0, recorded_hashes(&run.folder)[&21]);
    seek(&mut playback, SeekTarget::Last);
    assert_eq!(playback.session().day(), 21, "the playback stops before the invalid line");
}
