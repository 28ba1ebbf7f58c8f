//! Playback of a recorded run: forward, back, seeking, playing, taking over, following and recovering.

use std::path::{Path, PathBuf};

use novamind::record::folder::runs::list_runs;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::session::{Goal, Session, verify};
use novamind::worker::request::Recorded;
use serde_json::json;

use super::harness::Console;
use crate::support::company::begin_run;
use crate::support::dice::Dice;

/// Plays some weeks of a short run and returns its session.
pub fn played(runs: &Path, mode: Mode, weeks: u32) -> Session {
    let mut session = begin_run(runs, mode, 84);
    let mut call = |tool: &str, args: serde_json::Value| {
        session.call(tool, &args, Via::Form).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    };
    call("set_prices", json!({"A": 12, "B": 25, "C": 55}));
    call("set_model_tiers", json!({"B": 2, "C": 4}));
    call("set_usage_quotas", json!({"A": 60_000, "B": 250_000, "C": 1_200_000}));
    call("set_targeted_ad_spend", json!({"targeted_spend": {"content_marketing": {"S1": 750}}}));
    for week in 0..weeks {
        decide(&mut session, week);
    }
    session
}

/// The player's actions of a week.
fn decide(session: &mut Session, week: u32) {
    if week % 3 == 2 {
        session.query("SELECT plan, count(*) FROM subscriptions GROUP BY 1").expect("an answer");
        session.set_memo(&format!("week {week}: watch the ads")).expect("notes");
    }
    session.activity().note_view("cash", "overview", 4_200);
    session.call("set_prices", &json!({"A": -1}), Via::Form).expect_err("a price below zero");
    session.call("set_prices", &json!({"A": 12 + week}), Via::Form).expect("a price");
    session.call("set_daily_spend", &json!({"development": 100 * week}), Via::Form).expect("spending");
    let forecasts = session.company().naive_forecasts();
    let why = format!("If week {week} keeps its leads, a higher price of plan A pays for development.");
    session.advance(&why, &forecasts, Via::Form, &mut |_| {}).expect("a week");
}

/// Plays a run and closes it. Returns its folder.
fn left(runs: &Path, mode: Mode, weeks: u32) -> PathBuf {
    played(runs, mode, weeks).folder().expect("a folder").to_owned()
}

/// Opens the latest run in a replay.
pub fn replayed(runs: &Path, size: (u16, u16), goal: Goal) -> Console {
    let mut console = Console::start(runs, size);
    console.replay(Recorded::Run("latest".to_owned()), goal, false).expect("it opens");
    console
}

fn day(console: &Console) -> u32 {
    console.app.run().expect("a run").company.seen.day
}

#[test]
fn a_run_that_is_watched_from_far_away_fills_every_window() {
    let runs = tempfile::tempdir().expect("a folder");
    left(runs.path(), Mode::Sandbox, 4);
    for size in [(60, 16), (80, 24), (120, 40), (200, 60)] {
        let mut console = Console::start(runs.path(), size);
        console.project(Recorded::Run("latest".to_owned())).expect("it opens");
        let screen = console.screen();
        for part in ["day", "cash, last week", "subscribers", "█", "Cash", "Decided before w"] {
            assert!(screen.contains(part), "{part} is missing at {size:?}:\n{screen}");
        }
    }
}

#[test]
fn one_steps_forward_and_back_by_weeks_and_by_actions_and_seeks() {
    let runs = tempfile::tempdir().expect("a folder");
    let folder = left(runs.path(), Mode::Sandbox, 5);
    let before = std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory");
    let mut console = Console::start(runs.path(), (120, 40));
    // From the list of runs.
    console.press("down down enter r");
    console.shows("REPLAY");
    console.shows("◂ week 0/5 ▸  day 0");
    console.shows("Decided before week 1");
    console.shows("set_model_tiers B 2 C 4");
    console.press("> >");
    assert_eq!(day(&console), 14);
    console.shows("Decided before week 3");
    console.shows("“If week 2 keeps its leads");
    console.shows("later $98");
    console.shows("rejected: ");
    console.press("<");
    assert_eq!(day(&console), 7);
    // Single actions: the third sets a price.
    let price = |console: &Console| {
        console.app.run().expect("a run").company.setting(novamind::tools::ToolId::SetPrices, "A")
    };
    assert_eq!(price(&console), 12.0);
    console.press(") ) )");
    assert_eq!((day(&console), price(&console)), (7, 13.0));
    console.press("(");
    assert_eq!(price(&console), 12.0);
    console.press("# '4' enter");
    assert_eq!(day(&console), 28);
    console.press("# '9' enter");
    console.shows("week 9 was not recorded");
    console.press("esc }");
    assert_eq!(day(&console), 35);
    console.shows("end of the record");
    console.press(">");
    console.shows("end of the record");
    console.press("{");
    assert_eq!(day(&console), 0);
    // The screens show the current position.
    console.press("# '2' enter 9 esc i ctrl-n 'SELECT_max(day)_FROM_ledger' f5");
    console.shows("14");
    console.press("esc 0");
    console.shows("Journal");
    console.press("E");
    console.shows("rows in");
    console.press("esc D");
    assert!(!console.screen().contains("Decided before"), "the pane can be hidden");
    console.press("Q");
    console.shows("replay closed; nothing changed");
    drop(console);
    assert_eq!(std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory"), before);
}

#[test]
fn in_a_replay_nothing_can_be_done() {
    let runs = tempfile::tempdir().expect("a folder");
    left(runs.path(), Mode::Sandbox, 2);
    let mut console = replayed(runs.path(), (120, 40), Goal::Week(1));
    for keys in ["n", "u", "8 enter enter '12' enter ctrl-s", "esc esc 5 p", "0 e", "7 m", "7 r", "6 ctrl-s"]
    {
        console.press("esc esc");
        console.press(keys);
        console.shows("this is a replay; press T to take over");
    }
    console.press("esc esc :");
    console.press("'undo'");
    console.shows("not now, this is a replay");
    console.press("esc q");
    assert_eq!(console.left.as_ref().map(|(code, _)| *code), Some(0));
}

#[test]
fn it_plays_by_itself_until_the_end_and_pauses_at_a_key() {
    let runs = tempfile::tempdir().expect("a folder");
    left(runs.path(), Mode::Sandbox, 6);
    let mut console = replayed(runs.path(), (120, 40), Goal::First);
    console.press("F F F F F space");
    console.shows("playing, full speed");
    let mut days = vec![day(&console)];
    while day(&console) < 42 {
        let message = console.receive().expect("the next week");
        console.app.update(message);
        console.hand_over();
        if days.last() != Some(&day(&console)) {
            days.push(day(&console));
        }
        if day(&console) == 21 && days.len() == 4 {
            console.press("space");
            console.settle().expect("paused");
            let stands = day(&console);
            console.shows("paused");
            assert!(stands <= 28, "a week that was on its way may still come");
            console.press("space");
        }
    }
    assert_eq!(days, [0, 7, 14, 21, 28, 35, 42]);
    console.settle().expect("the end");
    console.shows("end of the record");
    console.press("S");
    console.shows("5 weeks per second");
}

#[test]
fn the_final_page_offers_a_replay_a_what_if_and_another_run_from_the_last_decision() {
    let runs = tempfile::tempdir().expect("a folder");
    let folder = left(runs.path(), Mode::Baseline, 12);
    let mut console = Console::start(runs.path(), (120, 40));
    console.open(&folder.file_name().expect("a name").to_string_lossy()).expect("it opens");
    console.shows("Day 84. You end with");
    console.shows("v replay");
    console.press("v");
    console.shows("◂ week 0/12 ▸");
    console.press("} n");
    console.shows("Day 84. You end with");
    console.press("b");
    console.shows("What if, from week 1 ");
    console.press("esc <");
    assert_eq!(day(&console), 77);
    console.press(") ) ) T");
    console.shows("on day 77 before week 12");
    console.press("down enter");
    console.shows("DEBUG");
    console.shows("from day 77");
    assert_eq!(day(&console), 77);
    console.week();
    console.shows("Day 84. You end with");
    console.press("esc q");
    drop(console);
    for run in list_runs(runs.path()).expect("a list") {
        assert_eq!(verify(&runs.path().join(&run.id)).expect("an intact run").day, 84);
    }
}

#[test]
fn an_unfinished_baseline_is_not_taken_over() {
    let runs = tempfile::tempdir().expect("a folder");
    left(runs.path(), Mode::Baseline, 2);
    let mut console = replayed(runs.path(), (120, 40), Goal::Week(1));
    console.press("T");
    console.shows("an unfinished baseline run cannot be branched");
    console.press("q");
    drop(console);
    assert_eq!(list_runs(runs.path()).expect("a list").len(), 1);
}

#[test]
fn a_run_in_use_is_watched_while_it_goes_on() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut owner = played(runs.path(), Mode::Sandbox, 2);
    let mut console = Console::start(runs.path(), (120, 40));
    console.press("c");
    console.shows("open in another program");
    console.shows("Watch it here");
    console.press("y");
    console.shows("live");
    assert_eq!(day(&console), 14);
    decide(&mut owner, 2);
    let until = |console: &mut Console, wanted: u32| {
        while day(console) < wanted {
            let message = console.receive().expect("new lines");
            console.app.update(message);
            console.hand_over();
        }
        console.settle().expect("all of it");
    };
    until(&mut console, 21);
    // The position stays while the record grows.
    console.press("<");
    assert_eq!(day(&console), 14);
    decide(&mut owner, 3);
    let lines = |console: &Console| {
        console.app.run().and_then(|run| run.viewer.as_ref()).map_or(0, |viewer| viewer.place.weeks)
    };
    while lines(&console) < 4 {
        let message = console.receive().expect("new lines");
        console.app.update(message);
        console.hand_over();
    }
    assert_eq!(day(&console), 14);
    console.press("}");
    until(&mut console, 28);
    console.press("q");
}

#[test]
fn the_good_beginning_of_a_damaged_run_is_opened_as_a_branch() {
    let runs = tempfile::tempdir().expect("a folder");
    let folder = left(runs.path(), Mode::Baseline, 3);
    let path = folder.join("trajectory.jsonl");
    let text = std::fs::read_to_string(&path).expect("a trajectory");
    let damaged = text.replace("If week 2 keeps", "If week 2 kept!");
    std::fs::write(&path, &damaged).expect("written");
    let mut console = Console::start(runs.path(), (80, 24));
    console.press("c");
    console.shows("Recover the undamaged part as a branch?");
    console.press("esc");
    assert_eq!(list_runs(runs.path()).expect("a list").len(), 1);
    console.press("c y");
    assert_eq!(day(&console), 14);
    console.shows("SANDBOX");
    console.press("q");
    drop(console);
    assert_eq!(std::fs::read_to_string(&path).expect("a trajectory"), damaged);
}

/// Random keys: those of a replay, and navigation.
const KEYS: [&str; 52] = [
    "<", ">", ">", ">", "(", ")", ")", "{", "}", "#", "space", "space", "F", "S", "D", "D", "E", "J", "K",
    "T", "1", "2", "3", "4", "5", "6", "7", "8", "9", "0", "tab", "enter", "enter", "esc", "esc", "esc",
    "up", "down", "left", "right", "n", "u", "c", "w", "d", "z", "f", "i", ":", "?", "ctrl-s", "e",
];

#[test]
fn random_keys_break_no_replay() {
    let mut dice = Dice::of_test("replay");
    let runs = tempfile::tempdir().expect("a folder");
    let folder = left(runs.path(), Mode::Sandbox, 4);
    let id = folder.file_name().expect("a name").to_string_lossy().into_owned();
    let before = std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory");
    let open = |size| {
        let mut console = Console::start(runs.path(), size);
        console.replay(Recorded::Run(id.clone()), Goal::Week(1), false).expect("it opens");
        console
    };
    let mut console = open((120, 40));
    let mut taken_over = 0;
    for _ in 0..500 {
        match dice.roll(12) {
            0 => console.size = (40 + dice.roll(140) as u16, 10 + dice.roll(50) as u16),
            1 => console.press("esc"),
            2 => console.press("'3'"),
            _ => {
                let key = *dice.pick(&KEYS);
                console.key(key);
            }
        }
        let viewed = console.app.run().is_some_and(|run| run.viewer.is_some());
        if !viewed {
            taken_over += u32::from(console.app.run().is_some());
            drop(console);
            console = open((120, 40));
        }
    }
    drop(console);
    assert!(taken_over > 0, "the dice never took the run over");
    assert_eq!(std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory"), before);
    for run in list_runs(runs.path()).expect("a list") {
        verify(&runs.path().join(&run.id)).expect("an intact run");
    }
}
