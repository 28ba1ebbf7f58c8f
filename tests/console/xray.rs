//! The X-ray screen: pictures, plain-mode commands, breakpoints, and missing permission.

use std::path::Path;

use crossterm::event::Event;
use novamind::insight::Inspect;
use novamind::record::mode::Mode;
use novamind::record::trajectory::Record;
use novamind::session::{Access, Goal, Session, lines_afterwards, verify};
use novamind::worker::request::Recorded;
use novamind::world::identifiers::Group;

use super::harness::Console;
use super::looks::{SIZES, picture};
use super::replay::replayed;
use crate::support::company::{begin_run, numbers, open_shop, weeks};
use crate::support::record::{folder_of, looks, recorded};

fn run(runs: &Path, mode: Mode, count: usize) -> Session {
    let mut session = begin_run(runs, mode, 84);
    open_shop(&mut session);
    weeks(&mut session, count);
    session
}

/// Opens a debug run of some weeks on the X-ray screen.
fn looking(runs: &Path, count: usize, size: (u16, u16)) -> Console {
    drop(run(runs, Mode::Debug, count));
    let mut console = Console::in_latest_run(runs, size);
    console.press("g x");
    console
}

#[test]
fn every_view_in_windows_of_four_sizes() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = looking(runs.path(), 10, SIZES[2]);
    let mut complaints = Vec::new();
    let views = [
        ("leads", "enter = enter down down = '0.5' enter"),
        ("quality", "esc down"),
        ("satisfaction", "down"),
        ("reputation", "down"),
        ("spillover", "down"),
        ("competitors", "down"),
        ("drift", "down"),
        ("streams", "down e 'service' enter esc"),
        ("customer", "down enter '3' enter enter '1200' enter"),
        ("breakpoints", "esc down enter enter 'churn(S1)>1%' enter e 'event' _ 'rival' enter"),
        ("commands", "a 'who' _ 'cash' _ '42' enter"),
    ];
    for (view, keys) in views {
        console.press(keys);
        let picture = picture(&mut console, &mut complaints);
        insta::assert_snapshot!(format!("xray-{view}"), picture);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn the_screen_says_what_plain_mode_says_and_each_look_is_a_line() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = looking(runs.path(), 4, (200, 60));
    // The group is typed, the day is chosen with keys.
    console.press("e 's2' enter left left ,");
    console.shows("day 19 of 28");
    let screen = console.screen();
    drop(console);
    let folder = folder_of(runs.path());
    let told = looks(&recorded(&folder));
    assert_eq!(told, ["leads S1 28", "leads S2 28", "leads S2 27", "leads S2 26", "leads S2 19"]);
    assert_eq!(verify(&folder).expect("it verifies").day, 28);
    let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
    let group = Group::parse("S2").expect("a group");
    let days = session.inspect().lead_equations(group, Some(19)).expect("a look");
    let own = days.last().expect("a day");
    for part in ["leads of S2 on day 19".to_owned(), format!("λ {:.2}, actual {}", own.expected(), own.came)] {
        assert!(screen.contains(&part), "{part} is missing in\n{screen}");
    }
}

#[test]
fn a_customer_who_left_is_shown_as_plain_mode_shows_it_with_its_day_in_the_title() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = run(runs.path(), Mode::Debug, 8);
    let sql =
        "SELECT customer_id, end_day FROM subscriptions WHERE status = 'cancelled' ORDER BY 2, 1 LIMIT 1";
    let left = numbers(&mut session, sql);
    let [customer, day] = left[0][..] else { panic!("a subscriber cancelled") };
    drop(session);
    let mut console = Console::in_latest_run(runs.path(), (200, 60));
    // A day that was chosen for a group does not apply to the customer.
    console.press("g x e 's2' _ '20' enter");
    console.shows("day 20 of 56");
    console.press("esc end up up");
    console.press(&format!("e '{customer}' enter"));
    console.shows(&format!("Customer {customer}"));
    console.shows(&format!("day {day} of 56"));
    console.shows(&format!("cancelled on day {day}"));
    console.press("left");
    console.shows(&format!("day {} of 56", day - 1.0));
    console.press(&format!("g d '{}' enter", day - 7.0));
    console.shows(&format!("day {} of 56", day - 7.0));
    let screen = console.screen();
    assert!(!screen.contains("cancelled on day"), "{screen}");
}

#[test]
fn looking_changes_no_hash() {
    let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let hashes = [true, false].map(|looks| {
        let runs = folders[usize::from(looks)].path();
        drop(run(runs, Mode::Debug, 3));
        let mut console = Console::in_latest_run(runs, (120, 40));
        if looks {
            console.press("g x left left = down tab down , . enter e 's2' enter 1");
        }
        console.week();
        drop(console);
        Session::open(&folder_of(runs), Access::Read, false).expect("it opens").state_hash()
    });
    assert_eq!(hashes[0], hashes[1]);
}

#[test]
fn a_held_factor_shows_the_expected_leads_beside() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = looking(runs.path(), 3, (120, 40));
    console.press("enter = enter");
    console.shows("with R 1: λ");
    console.press("down = '-1' enter");
    console.shows("D needs a number of at least 0");
    console.press("esc = '0.5' enter");
    console.shows("with R 1, D 0.5: λ");
    console.press("= up =");
    assert!(!console.screen().contains("rather than"), "{}", console.screen());
}

#[test]
fn a_debug_run_runs_to_a_breakpoint_that_is_set_on_the_screen() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(run(runs.path(), Mode::Debug, 2));
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.press("; k");
    console.shows("no breakpoint is set");
    console.press("e 'leads(S1)>1' enter e 'nonsense' enter");
    console.shows("nonsense");
    console.press("esc e 'cash<0' enter");
    console.shows("2 cash < 0");
    console.press("b");
    console.shows("cash < 0 is false on day 14");
    console.press("r 'x' enter");
    console.shows("type a number of days");
    console.press("esc tab tab down delete");
    assert!(!console.screen().contains("cash < 0"), "{}", console.screen());
    console.press("r '28' enter");
    console.shows("day 42");
    console.shows("breakpoint 1 was true on all these days and on the day before");
    console.press("e 'leads(S2)>=1' enter delete e 'cash<850000' enter r '20' enter");
    console.shows("stopped on day");
    drop(console);
    let told = looks(&recorded(&folder_of(runs.path())));
    assert!(told.contains(&"breakpoint leads(S1) > 1 42".to_owned()), "{told:?}");
}

#[test]
fn an_unfinished_run_of_another_mode_shows_one_sentence_and_no_tab() {
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let runs = tempfile::tempdir().expect("a folder");
        drop(run(runs.path(), mode, 1));
        let mut console = Console::in_latest_run(runs.path(), (120, 40));
        assert!(!console.screen().contains("X-ray"), "{}", console.screen());
        for keys in ["g x", "; k", "e r b = a left , delete enter tab down z"] {
            console.press(keys);
            let screen = console.screen();
            assert!(screen.contains("The x-ray works in debug runs and in runs that are over."), "{screen}");
            assert!(!screen.contains("g x X-ray") && !screen.contains("day 7 of"), "{screen}");
        }
        drop(console);
        assert_eq!(looks(&recorded(&folder_of(runs.path()))), Vec::<String>::new());
    }
}

#[test]
fn a_run_that_is_over_is_looked_into_in_its_replay_and_each_look_is_recorded() {
    for mode in [Mode::Baseline, Mode::Sandbox] {
        let runs = tempfile::tempdir().expect("a folder");
        let mut session = run(runs.path(), mode, 4);
        session.end().expect("it ends");
        drop(session);
        let mut console = replayed(runs.path(), (200, 60), Goal::Week(2));
        console.press("g x");
        console.shows("leads of S1 on day 14");
        console.press("right");
        console.shows("day 14 of 14");
        // A replay simulates nothing.
        console.press("; k r '7' enter");
        console.shows("this is a replay");
        // After leaving the replay, the run can be opened: its lock is released.
        console.press("esc Q");
        let folder = folder_of(runs.path());
        let id = folder.file_name().expect("a name").to_string_lossy().into_owned();
        console.open(&id).expect("it opens");
        drop(console);
        let after = lines_afterwards(&folder, &recorded(&folder)).expect("lines");
        assert_eq!(looks(&after), ["leads S1 14"]);
    }
}

#[test]
fn a_run_that_is_only_read_keeps_the_line_of_a_look() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = run(runs.path(), Mode::Sandbox, 2);
    session.end().expect("it ends");
    drop(session);
    let mut console = Console::start(runs.path(), (120, 40));
    console.look_at("latest").expect("it opens");
    console.press("esc g x");
    console.shows("leads of S1 on day 14");
    drop(console);
    let folder = folder_of(runs.path());
    let after = lines_afterwards(&folder, &recorded(&folder)).expect("lines");
    assert_eq!(looks(&after), ["leads S1 14"]);
}

#[test]
fn a_debug_run_that_somebody_else_plays_is_not_looked_into_from_its_replay() {
    let runs = tempfile::tempdir().expect("a folder");
    let held = run(runs.path(), Mode::Debug, 2);
    let mut console = replayed(runs.path(), (120, 40), Goal::Week(1));
    console.press("g x");
    assert!(!console.screen().contains("leads of S1 on day"), "{}", console.screen());
    drop(held);
}

#[test]
fn the_replay_of_an_unfinished_run_of_another_mode_shows_nothing() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(run(runs.path(), Mode::Sandbox, 2));
    let mut console = replayed(runs.path(), (120, 40), Goal::Week(1));
    console.press("g x");
    console.shows("The x-ray works in debug runs and in runs that are over.");
}

/// Types a command on the X-ray screen and sends it.
fn ask(console: &mut Console, words: &str) {
    console.press("a");
    console.send(Event::Paste(words.to_owned()));
    console.press("enter");
}

#[test]
fn words_are_answered_as_in_plain_mode_and_each_look_is_a_line() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = looking(runs.path(), 4, (200, 60));
    let asked =
        ["find leads(S1) >= 1", "who reputation(S1) 20", "diff 27 28", "set", "set group.S1.c_max_mean"];
    let mut screens = Vec::new();
    for words in asked {
        ask(&mut console, words);
        screens.push(console.screen());
    }
    console.press("a 'fond' enter");
    console.shows("did you mean find?");
    drop(console);
    let folder = folder_of(runs.path());
    let told = looks(&recorded(&folder));
    assert_eq!(told.len(), 4, "{told:?}");
    let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
    let shows = |screen: &str, part: &str| assert!(screen.contains(part), "{part:?} is missing in\n{screen}");
    let days = session.inspect().find_days("leads(S1) >= 1".parse().expect("a condition")).expect("days");
    shows(&screens[0], &format!("leads(S1) >= 1 became true on {} of 28 days", days.len()));
    let writes =
        session.inspect().who_writes("reputation(S1)".parse().expect("a figure"), Some(20)).expect("writes");
    shows(&screens[1], &format!("reputation(S1) on day 20: {:.9} → {:.9}", writes.first, writes.last));
    let found = session.inspect().difference_of_days(27, 28).expect("a difference");
    shows(&screens[2], &format!("differs: {}", found.parts.join(", ")));
    shows(&screens[3], "no parameter differs from");
    let value = session
        .company()
        .debug_parameters()
        .and_then(|own| own.value("group.S1.c_max_mean"))
        .expect("a value");
    shows(&screens[4], &format!("group.S1.c_max_mean = {value}"));
}

#[test]
fn a_parameter_is_set_after_a_question_and_in_debug_runs_alone() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = looking(runs.path(), 2, (120, 40));
    let before = console.app.run().map(|run| run.company.seen.day);
    ask(&mut console, "set group.S1.c_max_mean 300");
    console.shows("the run will not be ranked");
    console.press("esc");
    ask(&mut console, "set group.S1.c_max_mean");
    assert!(!console.screen().contains("= 300"), "{}", console.screen());
    ask(&mut console, "set group.S1.c_max_mean 300 from 20");
    console.press("y");
    console.shows("from day 20");
    // Changing the view and returning sends no new question.
    console.press("esc up down");
    console.shows("from day 20");
    assert_eq!(console.app.run().map(|run| run.company.seen.day), before);
    drop(console);
    let is_set = |record: &Record| matches!(record, Record::Override(_));
    let lines = recorded(&folder_of(runs.path()));
    assert_eq!(lines.lines.iter().filter(|line| is_set(&line.record)).count(), 1);

    let runs = tempfile::tempdir().expect("a folder");
    let mut session = run(runs.path(), Mode::Sandbox, 2);
    session.end().expect("it ends");
    let id = session.manifest().id.clone();
    drop(session);
    let mut console = Console::start(runs.path(), (120, 40));
    console.open(&id).expect("it opens");
    console.press("esc g x");
    ask(&mut console, "set group.S1.c_max_mean 300");
    console.press("y");
    console.shows("parameters can be set in debug runs only");
    drop(console);
    let mut console = replayed(runs.path(), (120, 40), Goal::Week(1));
    console.press("g x");
    ask(&mut console, "set group.S1.c_max_mean 300");
    console.shows("this is a replay");
}

#[test]
fn hidden_tables_are_asked_on_the_sql_screen_and_each_statement_is_a_look() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = looking(runs.path(), 3, (120, 40));
    console.press("9 'SELECT' _ 'count(*)' _ 'AS' _ 'days' _ 'FROM' _ 'hidden.pmi' shift-tab end right");
    let mut complaints = Vec::new();
    let text = picture(&mut console, &mut complaints);
    insta::assert_snapshot!("xray-sql", text);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    console.press("f5");
    console.shows("Query · x-ray");
    console.shows("Result · x-ray");
    console.shows("21");
    drop(console);
    let told = looks(&recorded(&folder_of(runs.path())));
    assert!(told.contains(&"sql SELECT count(*) AS days FROM hidden.pmi 21".to_owned()), "{told:?}");
}

#[test]
fn the_replay_of_a_run_that_is_over_asks_the_hidden_tables_of_the_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = run(runs.path(), Mode::Sandbox, 3);
    session.end().expect("it ends");
    drop(session);
    let mut console = replayed(runs.path(), (120, 40), Goal::Week(1));
    // An inspection before it opens the run without its database.
    console.press("g x 9 'SELECT' _ 'max(day)+100' _ 'FROM' _ 'hidden.drift' f5");
    console.shows("121");
    drop(console);
    let folder = folder_of(runs.path());
    let after = lines_afterwards(&folder, &recorded(&folder)).expect("lines");
    assert_eq!(looks(&after), ["leads S1 7", "sql SELECT max(day)+100 FROM hidden.drift 7"]);
}

#[test]
fn hidden_tables_stay_hidden_in_an_unfinished_run_of_another_mode() {
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let runs = tempfile::tempdir().expect("a folder");
        drop(run(runs.path(), mode, 1));
        let mut console = Console::in_latest_run(runs.path(), (120, 40));
        console.press("9 'SELECT' _ '*' _ 'FROM' _ 'hidden.groups' f5");
        let screen = console.screen();
        assert!(!screen.contains("x-ray") && !screen.contains("hidden.drift"), "{screen}");
        assert!(!screen.contains("reputation"), "{screen}");
        drop(console);
        let lines = recorded(&folder_of(runs.path()));
        assert_eq!(looks(&lines), Vec::<String>::new());
    }
}

#[test]
fn a_replay_begins_on_the_x_ray_screen_where_it_may() {
    for (ends, title) in [(true, "leads of S1 on day 14"), (false, "Overview")] {
        let runs = tempfile::tempdir().expect("a folder");
        let mut session = run(runs.path(), Mode::Sandbox, 2);
        if ends {
            session.end().expect("it ends");
        }
        drop(session);
        let mut console = Console::start(runs.path(), (200, 60));
        console.replay_inside(Recorded::Run("latest".to_owned()), Goal::Last).expect("it opens");
        console.shows(title);
        assert_eq!(console.screen().contains("leads of S1"), ends);
    }
}
