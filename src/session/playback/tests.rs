//! Tests of playback: every seek reaches the recorded state, and nothing on disk changes.

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

pub(crate) struct Recorded {
    _runs: tempfile::TempDir,
    pub folder: PathBuf,
    pub id: String,
}

/// Records a run with calls, a rejection, a query, notes and a view of a screen, and closes it.
pub(crate) fn recorded(mode: Mode, weeks: u32) -> Recorded {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play(runs.path(), mode, weeks);
    let (folder, id) = (session.folder().expect("a folder").to_owned(), session.manifest().id.clone());
    drop(session);
    Recorded { _runs: runs, folder, id }
}

fn play(runs: &Path, mode: Mode, weeks: u32) -> Session {
    let new = NewRun {
        seed: Some(7),
        days: Some(35),
        mode,
        storage: Storage::Runs(runs.to_owned()),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
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
            session.set_memo("remember the ads").expect("notes");
            session.activity().note_view("cash", "overview", 1_500);
        }
    }
    session
}

fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    entries.map(|path| (path.clone(), std::fs::read(path).expect("a file"))).collect()
}

fn go(playback: &mut Playback, goal: Goal) -> SeekResult {
    playback.go(goal, &mut |_| ControlFlow::Continue(())).expect("it goes there")
}

fn hashes(folder: &Path) -> BTreeMap<u32, String> {
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).expect("a trajectory");
    let hash = |line: &Line| Some((line.day, line.record.closing()?.state_hash.clone()));
    trajectory.lines.iter().filter_map(hash).collect()
}

#[test]
fn every_week_has_the_recorded_state_forward_back_and_by_seeking() {
    let run = recorded(Mode::Sandbox, 5);
    let before = files(&run.folder);
    let recorded = hashes(&run.folder);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    assert_eq!((playback.place().day, playback.place().week, playback.place().weeks), (0, 0, 5));
    let check = |playback: &mut Playback, week: u32| {
        assert_eq!(playback.session().day(), 7 * week);
        assert_eq!(playback.place().week, week);
        assert_eq!(playback.session().state_hash().0, recorded[&(7 * week)], "week {week}");
        let days = playback.session_mut().query("SELECT max(day) FROM ledger").expect("an answer");
        assert_eq!(days.rows[0][0], novamind_database::Cell::Integer(i64::from(7 * week)), "the database");
    };
    for week in 1..=5 {
        assert_eq!(go(&mut playback, Goal::Weeks(1)), SeekResult::There);
        check(&mut playback, week);
    }
    assert_eq!(
        playback.session().ended(),
        Some(novamind_record::trajectory::record::Ended::Horizon),
        "the end of the run belongs to its last week"
    );
    assert!(playback.at_end());
    for week in [4, 3] {
        assert_eq!(go(&mut playback, Goal::Weeks(-1)), SeekResult::Anew);
        check(&mut playback, week);
    }
    for week in [1, 5, 2, 4] {
        go(&mut playback, Goal::Week(week));
        check(&mut playback, week);
    }
    go(&mut playback, Goal::Weeks(-100));
    assert_eq!((playback.session().day(), playback.place().line), (0, 1));
    go(&mut playback, Goal::Weeks(3));
    check(&mut playback, 3);
    go(&mut playback, Goal::Last);
    check(&mut playback, 5);
    go(&mut playback, Goal::Week(99));
    check(&mut playback, 5);
    go(&mut playback, Goal::First);
    assert_eq!(playback.place().line, 1);
    drop(playback);
    assert_eq!(files(&run.folder), before, "a file changed");
}

#[test]
fn single_actions_show_the_company_between_the_weeks() {
    let run = recorded(Mode::Sandbox, 2);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    let price = |playback: &Playback| playback.session().company().current("set_prices")["A"].as_f64();
    assert_eq!(price(&playback), Some(0.0));
    go(&mut playback, Goal::Lines(1));
    assert_eq!(price(&playback), Some(12.0));
    let chapter = playback.place().chapter;
    assert_eq!((chapter.week, chapter.day, chapter.done, chapter.entries.len()), (1, 0, 1, 6));
    assert!(
        matches!(&chapter.entries[2].record, Record::Call(Call { tool, outcome: Outcome::Refused(_), .. }) if *tool == novamind_tools::ToolId::SetPrices)
    );
    go(&mut playback, Goal::Lines(-1));
    assert_eq!(price(&playback), Some(0.0));
    go(&mut playback, Goal::Lines(5));
    assert!(matches!(playback.place().chapter.entries[4].record, Record::Advance(_)));
    assert_eq!(playback.session().day(), 0, "the week is submitted, but not simulated");
    go(&mut playback, Goal::Lines(1));
    assert_eq!((playback.session().day(), playback.place().chapter.done), (7, 0));
}

#[test]
fn an_outcome_is_known_when_its_day_has_come_and_marked_before() {
    let run = recorded(Mode::Sandbox, 5);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    let foreseen = |playback: &Playback| {
        let chapter = playback.place().chapter;
        let filed = |entry: &RecordView| matches!(entry.record, Record::Advance(_));
        chapter.entries.into_iter().find(filed).expect("a submitted week")
    };
    let entry = foreseen(&playback);
    let early = &entry.forecasts;
    assert!(early.iter().all(|forecast| entry.is_later(forecast)));
    assert!(early[0].outcome.is_some() && early[1].outcome.is_some(), "days 7 and 28 were recorded");
    assert_eq!(early[2].outcome, None, "day 84 was not");
    go(&mut playback, Goal::Last);
    let entry = foreseen(&playback);
    let late = entry.forecasts[0];
    assert_eq!((late.due(), entry.is_later(&late)), (35, false), "the last chapter stays at the end");
    assert_eq!(late.outcome, playback.session().cash_by_day().last().copied());
}

#[test]
fn the_notes_are_shown_from_when_they_were_written() {
    let run = recorded(Mode::Sandbox, 3);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    assert_eq!(playback.memo(), None);
    go(&mut playback, Goal::Last);
    assert_eq!(playback.memo().as_deref(), Some("remember the ads"));
}

#[test]
fn nothing_can_be_done_and_a_long_way_can_be_stopped() {
    let run = recorded(Mode::Sandbox, 4);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    let refusal =
        playback.session_mut().call("set_prices", &json!({"A": 1}), Via::Form).expect_err("read-only");
    assert_eq!(refusal.code, "read_only");
    let mut days = Vec::new();
    let stopped = playback.go(Goal::Last, &mut |day| {
        days.push(day);
        if day < 14 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    assert_eq!((stopped.expect("no problem"), playback.session().day()), (SeekResult::Stopped, 14));
    assert_eq!(days, [7, 14]);
    go(&mut playback, Goal::Last);
    let back = playback.go(Goal::Week(2), &mut |_| ControlFlow::Break(())).expect("no problem");
    assert_eq!((back, playback.session().day()), (SeekResult::Stopped, 28), "back is all or nothing");
}

#[test]
fn what_is_taken_over_is_a_run_of_its_own_with_everything_up_to_there() {
    let run = recorded(Mode::Sandbox, 5);
    let mut playback = Playback::open(&run.folder).expect("it opens");
    go(&mut playback, Goal::Week(2));
    go(&mut playback, Goal::Lines(1));
    let mut branch = playback.take_over(Mode::Debug).expect("a branch");
    assert_eq!((branch.day(), branch.manifest().mode), (14, Mode::Debug));
    assert_eq!(
        branch.company().current("set_daily_spend")["operations"],
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
    go(&mut playback, Goal::First);
    go(&mut playback, Goal::Lines(5));
    assert_eq!(playback.take_over(Mode::Sandbox).expect("a branch").day(), 0);
    assert_eq!(playback.take_over(Mode::Baseline).err().expect("no baseline").code, "not_in_this_mode");
    go(&mut playback, Goal::Last);
    assert_eq!(playback.take_over(Mode::Sandbox).err().expect("it is over").code, "run_over");
}

#[test]
fn an_unfinished_baseline_is_not_taken_over() {
    let run = recorded(Mode::Baseline, 2);
    let playback = Playback::open(&run.folder).expect("it opens");
    assert!(playback.place().no_branch.expect("a reason").contains("end it first"));
    assert_eq!(playback.take_over(Mode::Sandbox).err().expect("refused").code, "not_in_this_mode");
    crate::play::open::end_run(run.folder.parent().expect("the runs"), &run.id).expect("it ends");
    let playback = Playback::open(&run.folder).expect("it opens");
    assert_eq!(playback.take_over(Mode::Sandbox).expect("a branch").day(), 0);
}

#[test]
fn a_trajectory_that_stands_alone_is_played_too() {
    let run = recorded(Mode::Sandbox, 3);
    let elsewhere = tempfile::tempdir().expect("a folder");
    let file = elsewhere.path().join("of a participant.jsonl");
    std::fs::copy(run.folder.join("trajectory.jsonl"), &file).expect("copied");
    let mut playback = Playback::open(&file).expect("it opens");
    go(&mut playback, Goal::Last);
    assert_eq!(playback.session().state_hash().0, hashes(&run.folder)[&21]);
    let verified = verify(&file).expect("it verifies");
    assert_eq!(verified, verify(&run.folder).expect("as the run does"));
    assert_eq!((verified.day, verified.states), (21, 3));
    assert_eq!(playback.take_over(Mode::Sandbox).err().expect("refused").code, "not_possible");
    let problem = Playback::open(&elsewhere.path().join("none.jsonl")).err().expect("there is none");
    assert!(problem.to_string().contains("none.jsonl"), "{problem}");
}

#[test]
fn a_run_that_is_played_elsewhere_is_followed() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut played = play(runs.path(), Mode::Sandbox, 2);
    let folder = played.folder().expect("a folder").to_owned();
    let mut playback = Playback::open(&folder).expect("it opens while the run is being written");
    playback.follow();
    go(&mut playback, Goal::Last);
    assert_eq!(playback.session().day(), 14);
    assert!(!playback.look_for_more().expect("no problem"), "nothing has happened");
    played.call("set_prices", &json!({"A": 15}), Via::Form).expect("a price");
    assert!(playback.look_for_more().expect("no problem"));
    go(&mut playback, Goal::Last);
    assert_eq!(playback.session().company().current("set_prices")["A"], 15.0);
    // A partial line is ignored.
    let path = folder.join("trajectory.jsonl");
    let whole = std::fs::read(&path).expect("a trajectory");
    let forecasts: Forecasts = played.company().naive_forecasts();
    played.advance("continue", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    let after = std::fs::read(&path).expect("a trajectory");
    drop(played);
    std::fs::write(&path, &after[..whole.len() + 40]).expect("a part of a line");
    assert!(!playback.look_for_more().expect("no problem"));
    std::fs::write(&path, &after).expect("the rest");
    assert!(playback.look_for_more().expect("no problem"));
    go(&mut playback, Goal::Last);
    assert_eq!(playback.session().state_hash().0, hashes(&folder)[&21]);
    std::fs::write(&path, &after[..60]).expect("a shorter file");
    assert!(playback.look_for_more().expect_err("lines are gone").to_string().contains("lines were removed"));
}

#[test]
fn a_state_that_is_not_reached_again_stops_before_it() {
    let run = recorded(Mode::Sandbox, 4);
    let path = run.folder.join("trajectory.jsonl");
    // Creates a valid hash chain with a changed call.
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
    let mut playback = Playback::open(&copy).expect("the chain is whole");
    let problem = playback.go(Goal::Last, &mut |_| ControlFlow::Continue(())).expect_err("another state");
    assert!(problem.to_string().contains("line"), "{problem}");
    let reached = playback.session().day();
    assert!(reached == 21, "{reached}");
    assert_eq!(playback.session().state_hash().0, hashes(&run.folder)[&21]);
    go(&mut playback, Goal::Last);
    assert_eq!(playback.session().day(), 21, "the playback does not pass it");
}
