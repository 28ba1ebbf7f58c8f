//! Playback of a recorded run: steps forward and back, seeking, continuous playback, branching, following a run in
//! use, and recovery.

use std::path::{Path, PathBuf};

use novamind::record::folder::runs::list_runs;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::session::{SeekTarget, Session, verify};
use novamind::worker::request::RecordSource;
use serde_json::json;

use super::harness::Console;
use crate::support::company::begin_run;
use crate::support::dice::Dice;

/// Plays a number of weeks of a short run and returns its session.
pub fn played_run(runs: &Path, mode: Mode, weeks: u32) -> Session {
    let mut session = begin_run(runs, mode, 84);
    let mut call = |tool: &str, args: serde_json::Value| {
        session.call(tool, &args, Via::Form).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    };
    call("set_prices", json!({"A": 12, "B": 25, "C": 55}));
    call("set_model_tiers", json!({"B": 2, "C": 4}));
    call("set_usage_quotas", json!({"A": 60_000, "B": 250_000, "C": 1_200_000}));
    call("set_targeted_ad_spend", json!({"targeted_spend": {"content_marketing": {"S1": 750}}}));
    for week in 0..weeks {
        decide_week(&mut session, week);
    }
    session
}

/// Applies the player's decisions of a week.
fn decide_week(session: &mut Session, week: u32) {
    if week % 3 == 2 {
        session.query("SELECT plan, count(*) FROM subscriptions GROUP BY 1").expect("an answer");
        session.set_notes(&format!("week {week}: watch the ads")).expect("notes");
    }
    session.activity().record_view("cash", "overview", 4_200);
    session.call("set_prices", &json!({"A": -1}), Via::Form).expect_err("a price below zero");
    session.call("set_prices", &json!({"A": 12 + week}), Via::Form).expect("a price");
    session.call("set_daily_spend", &json!({"development": 100 * week}), Via::Form).expect("spending");
    let forecasts = session.company().naive_forecasts();
    let why = format!("If week {week} keeps its leads, a higher price of plan A pays for development.");
    session.advance(&why, &forecasts, Via::Form, &mut |_| {}).expect("a week");
}

/// Plays a run and closes it. Returns its folder.
fn closed_run(runs: &Path, mode: Mode, weeks: u32) -> PathBuf {
    played_run(runs, mode, weeks).folder().expect("a folder").to_owned()
}

/// Opens the latest run in a replay.
pub fn console_in_replay(runs: &Path, size: (u16, u16), goal: SeekTarget) -> Console {
    let mut console = Console::start(runs, size);
    console.replay(RecordSource::Run("latest".to_owned()), goal, false).expect("it opens");
    console
}

fn shown_day(console: &Console) -> u32 {
    console.app.run().expect("a run").company.observation.day
}

#[test]
fn watch_view_fills_every_window() {
    let runs = tempfile::tempdir().expect("a folder");
    closed_run(runs.path(), Mode::Sandbox, 4);
    for size in [(60, 16), (80, 24), (120, 40), (200, 60)] {
        let mut console = Console::start(runs.path(), size);
        console.open_projector(RecordSource::Run("latest".to_owned())).expect("it opens");
        let screen = console.screen();
        for part in ["day", "cash, last week", "subscribers", "█", "Cash", "Decisions before"] {
            assert!(screen.contains(part), "{part} is missing at {size:?}:\n{screen}");
        }
    }
}

#[test]
fn playback_steps_by_weeks_and_actions_and_seeks() {
    let runs = tempfile::tempdir().expect("a folder");
    let folder = closed_run(runs.path(), Mode::Sandbox, 5);
    let before = std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory");
    let mut console = Console::start(runs.path(), (120, 40));
    // Opens the replay from the list of runs.
    console.press("down down enter r");
    console.assert_shows("REPLAY");
    console.assert_shows("◂ week 0/5 ▸  day 0");
    console.assert_shows("Decisions before week 1");
    console.assert_shows("set_model_tiers B 2 C 4");
    console.press("> >");
    assert_eq!(shown_day(&console), 14);
    console.assert_shows("Decisions before week 3");
    console.assert_shows("“If week 2 keeps its leads");
    console.assert_shows("later $98");
    console.assert_shows("rejected: ");
    console.press("<");
    assert_eq!(shown_day(&console), 7);
    // Steps through single actions. The third action sets a price.
    let price = |console: &Console| {
        console.app.run().expect("a run").company.current_setting(novamind::tools::ToolId::SetPrices, "A")
    };
    assert_eq!(price(&console), 12.0);
    console.press(") ) )");
    assert_eq!((shown_day(&console), price(&console)), (7, 13.0));
    console.press("(");
    assert_eq!(price(&console), 12.0);
    console.press("# '4' enter");
    assert_eq!(shown_day(&console), 28);
    console.press("# '9' enter");
    console.assert_shows("week 9 was not recorded");
    console.press("esc }");
    assert_eq!(shown_day(&console), 35);
    console.assert_shows("end of the record");
    console.press(">");
    console.assert_shows("end of the record");
    console.press("{");
    assert_eq!(shown_day(&console), 0);
    // The screens show the run at the current position of the playback.
    console.press("# '2' enter 9 i ctrl-n 'SELECT_max(day)_FROM_ledger' f5");
    console.assert_shows("14");
    console.press("esc 0");
    console.assert_shows("Journal");
    console.press("E");
    console.assert_shows("rows in");
    console.press("esc D");
    assert!(!console.screen().contains("Decided before"), "the pane can be hidden");
    console.press("Q");
    console.assert_shows("replay closed; nothing changed");
    drop(console);
    assert_eq!(std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory"), before);
}

#[test]
fn replay_is_read_only() {
    let runs = tempfile::tempdir().expect("a folder");
    closed_run(runs.path(), Mode::Sandbox, 2);
    let mut console = console_in_replay(runs.path(), (120, 40), SeekTarget::Week(1));
    for keys in ["n", "u", "8 enter enter '12' enter ctrl-s", "esc esc 5 p", "0 e", "7 m", "7 r", "6 ctrl-s"]
    {
        console.press("esc esc");
        console.press(keys);
        console.assert_shows("this is a replay; press T to take over");
    }
    console.press("esc esc :");
    console.press("'undo'");
    console.assert_shows("unavailable (this is a replay)");
    console.press("esc q");
    assert_eq!(console.exit.as_ref().map(|(code, _)| *code), Some(0));
}

#[test]
fn playback_runs_to_the_end_and_pauses_at_a_key() {
    let runs = tempfile::tempdir().expect("a folder");
    closed_run(runs.path(), Mode::Sandbox, 6);
    let mut console = console_in_replay(runs.path(), (120, 40), SeekTarget::First);
    console.press("F F F F F space");
    console.assert_shows("playing, full speed");
    let mut days = vec![shown_day(&console)];
    while shown_day(&console) < 42 {
        let message = console.receive().expect("the next week");
        console.app.handle_message(message);
        console.dispatch_orders();
        if days.last() != Some(&shown_day(&console)) {
            days.push(shown_day(&console));
        }
        if shown_day(&console) == 21 && days.len() == 4 {
            console.press("space");
            console.wait_until_idle().expect("paused");
            let paused_day = shown_day(&console);
            console.assert_shows("paused");
            assert!(paused_day <= 28, "a week that was on its way may still come");
            console.press("space");
        }
    }
    assert_eq!(days, [0, 7, 14, 21, 28, 35, 42]);
    console.wait_until_idle().expect("the end");
    console.assert_shows("end of the record");
    console.press("S");
    console.assert_shows("5 weeks per second");
}

#[test]
fn final_page_offers_replay_what_if_and_branch_from_the_last_decision() {
    let runs = tempfile::tempdir().expect("a folder");
    let folder = closed_run(runs.path(), Mode::Baseline, 12);
    let mut console = Console::start(runs.path(), (120, 40));
    console.open(&folder.file_name().expect("a name").to_string_lossy()).expect("it opens");
    console.assert_shows("Day 84. You end with");
    console.assert_shows("v replay");
    console.press("v");
    console.assert_shows("◂ week 0/12 ▸");
    console.press("} n");
    console.assert_shows("Day 84. You end with");
    console.press("b");
    console.assert_shows("What if, decisions of week 1 ");
    console.press("esc <");
    assert_eq!(shown_day(&console), 77);
    console.press(") ) ) T");
    console.assert_shows("on day 77 before week 12");
    console.press("down enter");
    console.assert_shows("DEBUG");
    console.assert_shows("from day 77");
    assert_eq!(shown_day(&console), 77);
    console.advance_week();
    console.assert_shows("Day 84. You end with");
    console.press("esc q");
    drop(console);
    for run in list_runs(runs.path()).expect("a list") {
        assert_eq!(verify(&runs.path().join(&run.id)).expect("an intact run").day, 84);
    }
}

#[test]
fn unfinished_baseline_replay_cannot_branch() {
    let runs = tempfile::tempdir().expect("a folder");
    closed_run(runs.path(), Mode::Baseline, 2);
    let mut console = console_in_replay(runs.path(), (120, 40), SeekTarget::Week(1));
    console.press("T");
    console.assert_shows("an unfinished baseline run cannot be branched");
    console.press("q");
    drop(console);
    assert_eq!(list_runs(runs.path()).expect("a list").len(), 1);
}

#[test]
fn run_in_use_can_be_watched() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut owner = played_run(runs.path(), Mode::Sandbox, 2);
    let mut console = Console::start(runs.path(), (120, 40));
    console.press("c");
    console.assert_shows("open in another program");
    console.assert_shows("Watch the run here");
    console.press("y");
    console.assert_shows("live");
    assert_eq!(shown_day(&console), 14);
    decide_week(&mut owner, 2);
    let until = |console: &mut Console, wanted: u32| {
        while shown_day(console) < wanted {
            let message = console.receive().expect("new lines");
            console.app.handle_message(message);
            console.dispatch_orders();
        }
        console.wait_until_idle().expect("all of it");
    };
    until(&mut console, 21);
    // The position of the playback does not change while the record grows.
    console.press("<");
    assert_eq!(shown_day(&console), 14);
    decide_week(&mut owner, 3);
    let lines = |console: &Console| {
        console.app.run().and_then(|run| run.playback.as_ref()).map_or(0, |viewer| viewer.position.weeks)
    };
    while lines(&console) < 4 {
        let message = console.receive().expect("new lines");
        console.app.handle_message(message);
        console.dispatch_orders();
    }
    assert_eq!(shown_day(&console), 14);
    console.press("}");
    until(&mut console, 28);
    console.press("q");
}

#[test]
fn recovery_opens_the_undamaged_prefix_as_a_branch() {
    let runs = tempfile::tempdir().expect("a folder");
    let folder = closed_run(runs.path(), Mode::Baseline, 3);
    let path = folder.join("trajectory.jsonl");
    let text = std::fs::read_to_string(&path).expect("a trajectory");
    let damaged = text.replace("If week 2 keeps", "If week 2 kept!");
    std::fs::write(&path, &damaged).expect("written");
    let mut console = Console::start(runs.path(), (80, 24));
    console.press("c");
    console.assert_shows("Recover the undamaged part as a branch?");
    console.press("esc");
    assert_eq!(list_runs(runs.path()).expect("a list").len(), 1);
    console.press("c y");
    assert_eq!(shown_day(&console), 14);
    console.assert_shows("SANDBOX");
    console.press("q");
    drop(console);
    assert_eq!(std::fs::read_to_string(&path).expect("a trajectory"), damaged);
}

/// Keys that are pressed at random: keys of a replay, and keys for navigation.
const KEYS: [&str; 52] = [
    "<", ">", ">", ">", "(", ")", ")", "{", "}", "#", "space", "space", "F", "S", "D", "D", "E", "J", "K",
    "T", "1", "2", "3", "4", "5", "6", "7", "8", "9", "0", "tab", "enter", "enter", "esc", "esc", "esc",
    "up", "down", "left", "right", "n", "u", "c", "w", "d", "z", "f", "i", ":", "?", "ctrl-s", "e",
];

#[test]
fn random_keys_do_not_panic_in_replay() {
    let mut dice = Dice::for_test("replay");
    let runs = tempfile::tempdir().expect("a folder");
    let folder = closed_run(runs.path(), Mode::Sandbox, 4);
    let id = folder.file_name().expect("a name").to_string_lossy().into_owned();
    let before = std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory");
    let open = |size| {
        let mut console = Console::start(runs.path(), size);
        console.replay(RecordSource::Run(id.clone()), SeekTarget::Week(1), false).expect("it opens");
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
                console.press_key(key);
            }
        }
        let is_playback = console.app.run().is_some_and(|run| run.playback.is_some());
        if !is_playback {
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
