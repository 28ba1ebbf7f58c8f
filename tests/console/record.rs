//! Recorded user activity at the console, compared with the actions of a script.

use std::path::Path;
use std::time::Duration;

use crossterm::event::Event;
use novamind::record::folder::configuration::Configuration;
use novamind::record::folder::runs::find_run;
use novamind::record::trajectory::record::{
    Activity, ClockEvent, DetachCause, PresenceEvent, QuerySource, ScreenView, TextEdit, TextEditOutcome,
};
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::{NewRun, Session, Storage, verify};

use super::harness::Console;

/// Returns the recorded lines of the only run in a folder.
fn recorded_lines(runs: &Path) -> Vec<Record> {
    let folder = find_run(runs, "latest").expect("a run");
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).expect("lines");
    trajectory.lines.into_iter().map(|line| line.record).collect()
}

fn activities(runs: &Path) -> Vec<Activity> {
    let activity = |record| if let Record::Activity(activity) = record { Some(activity) } else { None };
    recorded_lines(runs).into_iter().filter_map(activity).collect()
}

fn views(runs: &Path) -> Vec<ScreenView> {
    let view = |activity| if let Activity::View(view) = activity { Some(view) } else { None };
    activities(runs).into_iter().filter_map(view).collect()
}

fn drafts(runs: &Path) -> Vec<TextEdit> {
    let draft = |activity| if let Activity::Draft(draft) = activity { Some(draft) } else { None };
    activities(runs).into_iter().filter_map(draft).collect()
}

fn presence_events(runs: &Path) -> Vec<PresenceEvent> {
    let event =
        |activity| if let Activity::Session(presence) = activity { Some(presence.event) } else { None };
    activities(runs).into_iter().filter_map(event).collect()
}

fn advance_clock(console: &mut Console, seconds: u64) {
    console.advance_time(Duration::from_secs(seconds)).expect("time passes");
}

/// Describes each event by its kind and its relevant values, one event per line.
fn activity_lines(runs: &Path) -> Vec<String> {
    let one = |record: Record| match record {
        Record::Activity(Activity::View(view)) => {
            format!("view {} from {} {} s", view.screen, view.from, view.for_ms / 1000)
        }
        Record::Activity(Activity::Select(select)) => format!("select {} {}", select.what, select.which),
        Record::Activity(Activity::Dialog(dialog)) => {
            let steps: Vec<String> =
                dialog.steps.iter().map(|step| format!("{} {}", step.step, step.for_ms / 1000)).collect();
            format!("dialog {} {:?} {}", dialog.what, dialog.outcome, steps.join(" ")).trim_end().to_owned()
        }
        Record::Activity(Activity::Help(help)) => format!("help {} in {}", help.term, help.place),
        Record::Activity(Activity::Draft(draft)) => {
            format!("draft {} {:?} {} letters", draft.place, draft.outcome, draft.length)
        }
        Record::Activity(Activity::Clock(clock)) => format!("clock {:?}", clock.event),
        Record::Activity(Activity::Session(presence)) => format!("session {:?}", presence.event),
        Record::Query(query) => format!("query {:?}", query.via.expect("format 2")),
        Record::Call(call) => format!("call {}", call.tool),
        Record::Advance(_) => "advance".to_owned(),
        Record::Week(_) => "week".to_owned(),
        Record::Note(_) => "note".to_owned(),
        Record::Start(_) => "start".to_owned(),
        other => format!("{other:?}"),
    };
    recorded_lines(runs).into_iter().map(one).collect()
}

#[test]
fn activities_are_recorded_in_order() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    advance_clock(&mut console, 5);
    console.press("2");
    advance_clock(&mut console, 7);
    console.press("i");
    advance_clock(&mut console, 2);
    console.press("esc 3 enter");
    advance_clock(&mut console, 3);
    console.press("n");
    advance_clock(&mut console, 4);
    console.press("enter 'wait'");
    advance_clock(&mut console, 6);
    console.press("enter f enter");
    advance_clock(&mut console, 1);
    console.press("esc 2 q");
    drop(console);
    let texts = activity_lines(runs.path());
    let term = texts.iter().find(|line| line.starts_with("help ")).cloned().unwrap_or_default();
    assert!(term.ends_with(" in cash"), "{texts:#?}");
    let expected = [
        "start",
        "session Opened",
        "view overview from  5 s",
        &term,
        "dialog explanation Cancelled",
        "view cash from overview 9 s",
        "select group S1",
        "dialog next week Confirmed review 4 rationale 6 forecasts 0",
        "draft rationale Sent 4 letters",
        "view customers from cash 13 s",
        "advance",
        "week",
        "dialog week report Cancelled",
        "view customers from cash 1 s",
        "view cash from customers 0 s",
        "session Closed",
    ];
    assert_eq!(texts, expected);
}

#[test]
fn screen_time_never_exceeds_week_time() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    for week in 0..3 {
        for key in ["2", "3", "4", "1", "backspace", "]"] {
            advance_clock(&mut console, week + 1);
            console.press(key);
        }
        console.advance_week();
        console.press("esc");
    }
    drop(console);
    let views = views(runs.path());
    assert!(views.iter().all(|view| view.from != view.screen), "{views:#?}");
    let mut before_week = vec![0];
    for record in recorded_lines(runs.path()) {
        match record {
            Record::Activity(Activity::View(view)) => *before_week.last_mut().expect("one") += view.for_ms,
            Record::Advance(_) => before_week.push(0),
            _ => {}
        }
    }
    let turned: Vec<u64> = before_week.iter().map(|ms| ms / 6000).collect();
    assert_eq!(turned[..3], [1, 2, 3], "{before_week:?}");
}

#[test]
fn drafts_record_how_text_was_entered() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    // The notes are typed, deleted, pasted and saved, with a pause.
    console.press("0 tab e 'abcx' backspace");
    advance_clock(&mut console, 3);
    console.send(Event::Paste(" pasted".to_owned()));
    console.press("ctrl-s");
    // An SQL statement is typed and not run.
    console.press("9 enter 'SELECT1' esc esc 1");
    drop(console);
    let drafts = drafts(runs.path());
    let [notes, sql] = &drafts[..] else { panic!("{drafts:#?}") };
    assert_eq!((notes.place.as_str(), notes.outcome), ("notes", TextEditOutcome::Sent));
    assert_eq!((notes.length, notes.typed, notes.deleted, notes.pasted, notes.pauses), (10, 4, 1, 7, 1));
    assert!(notes.for_ms >= 3000 && notes.text.is_none());
    assert_eq!((sql.place.as_str(), sql.outcome, sql.typed), ("sql", TextEditOutcome::Left, 7));
}

#[test]
fn run_is_hidden_while_the_clock_is_stopped() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    advance_clock(&mut console, 5);
    console.press("; p");
    for size in [(120, 40), (60, 16), (200, 60)] {
        console.size = size;
        let screen = console.screen();
        assert!(screen.contains("The clock is stopped."), "{screen}");
        for word in ["cash", "day", "$", "NovaMind", "SANDBOX", "Overview", "subs"] {
            assert!(!screen.contains(word), "{word} is seen:\n{screen}");
        }
    }
    // While the clock is stopped, keys have no effect and time does not count.
    console.press("3 n enter");
    advance_clock(&mut console, 100);
    console.press("; p esc");
    drop(console);
    let texts = activity_lines(runs.path());
    let expected = ["start", "session Opened", "view overview from  5 s", "clock Stopped", "clock Started"];
    assert_eq!(texts[..5], expected, "{texts:#?}");
    assert!(texts.iter().filter(|line| *line == "clock Stopped").count() == 2, "{texts:#?}");
    // If the program ended while the clock was stopped, the clock starts when the run is opened again.
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.assert_shows("NovaMind");
    drop(console);
    let forgotten = activities(runs.path()).into_iter().any(
        |activity| matches!(activity, Activity::Clock(clock) if clock.event == ClockEvent::Forgotten && clock.stood_ms.is_some()),
    );
    assert!(forgotten);
}

#[test]
fn idle_time_is_recorded_until_a_key() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    advance_clock(&mut console, 59);
    console.press("2");
    advance_clock(&mut console, 60);
    advance_clock(&mut console, 30);
    console.send(Event::FocusLost);
    console.send(Event::FocusGained);
    console.press("3");
    console.send(Event::Resize(90, 30));
    advance_clock(&mut console, 1);
    drop(console);
    use PresenceEvent::{Active, Closed, FocusGained, FocusLost, Idle, Opened, Resized};
    assert_eq!(presence_events(runs.path()), [Opened, Idle, FocusLost, FocusGained, Active, Resized, Closed]);
    let all = activities(runs.path());
    let idle = |activity: &Activity| match activity {
        Activity::Session(presence) => presence.idle_ms.map(|ms| ms / 1000),
        _ => None,
    };
    assert_eq!(all.iter().filter_map(idle).collect::<Vec<_>>(), [60, 90]);
    let closed = all.iter().rev().find_map(|activity| match activity {
        Activity::Session(presence) => presence.cause,
        _ => None,
    });
    assert_eq!(closed, Some(DetachCause::Quit));
}

#[test]
fn drafts_survive_a_crash_until_discarded() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press("n enter 'because' _ 'of' _ 'S1'");
    advance_clock(&mut console, 4);
    console.press("esc 8 enter");
    console.press("enter '77' enter");
    advance_clock(&mut console, 4);
    console.press("g q enter 'SELECT' _ '4'");
    advance_clock(&mut console, 4);
    let file = find_run(runs.path(), "latest").expect("a run").join("drafts.json");
    let all = ["because of S1", "77", "SELECT 4"];
    let kept = || std::fs::read_to_string(&file).unwrap_or_default();
    // The session thread saves the drafts asynchronously.
    while !all.iter().all(|text| kept().contains(text)) {
        std::thread::yield_now();
    }
    // Signal 1 is the hangup signal.
    console.app.handle_message(novamind::worker::message::Message::Signal(1));
    console.wait_until_idle().expect("it leaves");
    drop(console);
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.assert_shows("Unsent when");
    console.assert_shows("because of S1");
    console.press("y");
    console.press("n enter");
    console.assert_shows("because of S1");
    drop(console);
    let restored: Vec<String> = drafts(runs.path())
        .into_iter()
        .filter(|draft| draft.outcome == TextEditOutcome::Restored)
        .map(|draft| draft.place)
        .collect();
    assert_eq!(restored.len(), 3, "{restored:?}");
    assert_eq!((restored[0].as_str(), restored[1].as_str()), ("rationale", "sql"));
    assert!(restored[2].starts_with("form "));
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.press("d");
    console.wait_until_idle().expect("it is dropped");
    drop(console);
    assert!(!file.exists(), "discarded drafts are deleted");
}

#[test]
fn queries_record_their_source() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.advance_week();
    console.press("esc 9 enter 'SELECT' _ '1' esc f5 v ctrl-o enter 2 f esc");
    drop(console);
    let via: Vec<QuerySource> = recorded_lines(runs.path())
        .into_iter()
        .filter_map(|record| if let Record::Query(query) = record { query.via } else { None })
        .collect();
    assert_eq!(via, [QuerySource::Typed, QuerySource::Derived, QuerySource::Library, QuerySource::DrillDown]);
}

#[test]
fn attention_records_do_not_change_the_state_hash() {
    let play = |attentive: bool| {
        let runs = tempfile::tempdir().expect("a folder");
        let storage = Storage::Runs(runs.path().to_owned());
        let new = NewRun { seed: Some(5), days: Some(28), storage, ..NewRun::default() };
        drop(Session::create(new, &Configuration::bundled()).expect("a run"));
        let mut console = Console::in_latest_run(runs.path(), (120, 40));
        for _ in 0..2 {
            if attentive {
                console.press("2 i esc 3 enter 9 enter 'SELECT' _ '1' esc esc ; p enter");
                advance_clock(&mut console, 70);
            }
            console.advance_week();
            console.press("esc");
        }
        drop(console);
        let found = verify(&find_run(runs.path(), "latest").expect("a run")).expect("it verifies");
        (found.states, found.state_hash, found.lines)
    };
    let (attentive, hasty) = (play(true), play(false));
    assert_eq!((attentive.0, &attentive.1), (hasty.0, &hasty.1));
    assert!(attentive.2 > hasty.2 + 10, "viewed objects are recorded");
}

#[test]
fn read_posts_stay_read_after_reopening() {
    let runs = tempfile::tempdir().expect("a folder");
    super::company::copy_played_run("crisis.toml", 5, 28, runs.path());
    let has_badge = |console: &mut Console| console.screen().contains("5 Social ●");
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    assert!(has_badge(&mut console), "the posts of the week are new:\n{}", console.screen());
    drop(console);
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    assert!(has_badge(&mut console), "the overview shows no posts");
    console.press("5 1");
    assert!(!has_badge(&mut console));
    drop(console);
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    assert!(!has_badge(&mut console), "they were read in an earlier session:\n{}", console.screen());
    console.advance_week();
    console.press("esc 1");
    assert!(has_badge(&mut console), "posts of the new week are new:\n{}", console.screen());
}
