//! The X-ray screen: snapshots, plain-mode commands, breakpoints, and missing permission.

use std::path::Path;

use crossterm::event::Event;
use novamind::insight::Inspect;
use novamind::record::mode::Mode;
use novamind::record::trajectory::Record;
use novamind::session::{Access, SeekTarget, Session, read_afterwards, verify};
use novamind::worker::request::RecordSource;
use novamind::world::identifiers::Group;

use super::harness::Console;
use super::picture_checks::{SIZES, snapshot_text};
use super::replay::console_in_replay;
use crate::support::company::{advance_weeks, apply_opening_decisions, begin_run, query_numbers};
use crate::support::record::{inspections, read_trajectory, run_folder};

fn create_run(runs: &Path, mode: Mode, count: usize) -> Session {
    let mut session = begin_run(runs, mode, 84);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, count);
    session
}

/// Opens a debug run of `count` weeks on the X-ray screen.
fn console_on_xray_screen(runs: &Path, count: usize, size: (u16, u16)) -> Console {
    drop(create_run(runs, Mode::Debug, count));
    let mut console = Console::in_latest_run(runs, size);
    console.press("g x");
    console
}

#[test]
fn xray_views_match_snapshots() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_on_xray_screen(runs.path(), 10, SIZES[2]);
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
        let picture = snapshot_text(&mut console, &mut complaints);
        insta::assert_snapshot!(format!("xray-{view}"), picture);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn xray_screen_matches_plain_mode_and_records_inspections() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_on_xray_screen(runs.path(), 4, (200, 60));
    // The group is typed, and the day is selected with keys.
    console.press("e 's2' enter left left ,");
    console.assert_shows("day 19 of 28");
    let screen = console.screen();
    drop(console);
    let folder = run_folder(runs.path());
    let texts = inspections(&read_trajectory(&folder));
    assert_eq!(texts, ["leads S1 28", "leads S2 28", "leads S2 27", "leads S2 26", "leads S2 19"]);
    assert_eq!(verify(&folder).expect("it verifies").day, 28);
    let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
    let group = Group::parse("S2").expect("a group");
    let days = session.inspect().lead_equations(group, Some(19)).expect("a result");
    let lead_equation = days.last().expect("a day");
    for part in [
        "leads of S2 on day 19".to_owned(),
        format!("λ {:.2}, actual {}", lead_equation.expected_leads(), lead_equation.actual_leads),
    ] {
        assert!(screen.contains(&part), "{part} is missing in\n{screen}");
    }
}

#[test]
fn former_customer_is_shown_as_in_plain_mode() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = create_run(runs.path(), Mode::Debug, 8);
    let sql =
        "SELECT customer_id, end_day FROM subscriptions WHERE status = 'cancelled' ORDER BY 2, 1 LIMIT 1";
    let left = query_numbers(&mut session, sql);
    let [customer, day] = left[0][..] else { panic!("a subscriber cancelled") };
    drop(session);
    let mut console = Console::in_latest_run(runs.path(), (200, 60));
    // A day that was selected for a group does not apply to a customer.
    console.press("g x e 's2' _ '20' enter");
    console.assert_shows("day 20 of 56");
    console.press("esc end up up");
    console.press(&format!("e '{customer}' enter"));
    console.assert_shows(&format!("Customer {customer}"));
    console.assert_shows(&format!("day {day} of 56"));
    console.assert_shows(&format!("cancelled on day {day}"));
    console.press("left");
    console.assert_shows(&format!("day {} of 56", day - 1.0));
    console.press(&format!("g d '{}' enter", day - 7.0));
    console.assert_shows(&format!("day {} of 56", day - 7.0));
    let screen = console.screen();
    assert!(!screen.contains("cancelled on day"), "{screen}");
}

#[test]
fn inspections_do_not_change_the_state_hash() {
    let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let hashes = [true, false].map(|inspects| {
        let runs = folders[usize::from(inspects)].path();
        drop(create_run(runs, Mode::Debug, 3));
        let mut console = Console::in_latest_run(runs, (120, 40));
        if inspects {
            console.press("g x left left = down tab down , . enter e 's2' enter 1");
        }
        console.advance_week();
        drop(console);
        Session::open(&run_folder(runs), Access::Read, false).expect("it opens").state_hash()
    });
    assert_eq!(hashes[0], hashes[1]);
}

#[test]
fn fixed_lead_factor_shows_expected_leads() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_on_xray_screen(runs.path(), 3, (120, 40));
    console.press("enter = enter");
    console.assert_shows("with R 1: λ");
    console.press("down = '-1' enter");
    console.assert_shows("D needs a number of at least 0");
    console.press("esc = '0.5' enter");
    console.assert_shows("with R 1, D 0.5: λ");
    console.press("= up =");
    assert!(!console.screen().contains("rather than"), "{}", console.screen());
}

#[test]
fn debug_run_stops_at_a_breakpoint_set_on_the_xray_screen() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(create_run(runs.path(), Mode::Debug, 2));
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.press("; k");
    console.assert_shows("no breakpoint is set");
    console.press("e 'leads(S1)>1' enter e 'nonsense' enter");
    console.assert_shows("nonsense");
    console.press("esc e 'cash<0' enter");
    console.assert_shows("2 cash < 0");
    console.press("b");
    console.assert_shows("cash < 0 is false on day 14");
    console.press("r 'x' enter");
    console.assert_shows("type a number of days");
    console.press("esc tab tab down delete");
    assert!(!console.screen().contains("cash < 0"), "{}", console.screen());
    console.press("r '28' enter");
    console.assert_shows("day 42");
    console.assert_shows("breakpoint 1 was true on all these days and on the day before");
    console.press("e 'leads(S2)>=1' enter delete e 'cash<850000' enter r '20' enter");
    console.assert_shows("stopped on day");
    drop(console);
    let texts = inspections(&read_trajectory(&run_folder(runs.path())));
    assert!(texts.contains(&"breakpoint leads(S1) > 1 42".to_owned()), "{texts:?}");
}

#[test]
fn xray_screen_is_unavailable_in_unfinished_non_debug_runs() {
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let runs = tempfile::tempdir().expect("a folder");
        drop(create_run(runs.path(), mode, 1));
        let mut console = Console::in_latest_run(runs.path(), (120, 40));
        assert!(!console.screen().contains("X-ray"), "{}", console.screen());
        for keys in ["g x", "; k", "e r b = a left , delete enter tab down z"] {
            console.press(keys);
            let screen = console.screen();
            assert!(
                screen.contains("The x-ray is available in debug runs and in runs that have ended."),
                "{screen}"
            );
            assert!(!screen.contains("g x X-ray") && !screen.contains("day 7 of"), "{screen}");
        }
        drop(console);
        assert_eq!(inspections(&read_trajectory(&run_folder(runs.path()))), Vec::<String>::new());
    }
}

#[test]
fn replay_of_a_finished_run_records_inspections() {
    for mode in [Mode::Baseline, Mode::Sandbox] {
        let runs = tempfile::tempdir().expect("a folder");
        let mut session = create_run(runs.path(), mode, 4);
        session.abandon().expect("it ends");
        drop(session);
        let mut console = console_in_replay(runs.path(), (200, 60), SeekTarget::Week(2));
        console.press("g x");
        console.assert_shows("leads of S1 on day 14");
        console.press("right");
        console.assert_shows("day 14 of 14");
        // A replay cannot simulate days and therefore cannot run to a breakpoint.
        console.press("; k r '7' enter");
        console.assert_shows("this is a replay");
        // After the replay is closed, the lock of the run is released and the run can be opened.
        console.press("esc Q");
        let folder = run_folder(runs.path());
        let id = folder.file_name().expect("a name").to_string_lossy().into_owned();
        console.open(&id).expect("it opens");
        drop(console);
        let after = read_afterwards(&folder, &read_trajectory(&folder)).expect("lines");
        assert_eq!(inspections(&after), ["leads S1 14"]);
    }
}

#[test]
fn read_only_run_records_inspections() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = create_run(runs.path(), Mode::Sandbox, 2);
    session.abandon().expect("it ends");
    drop(session);
    let mut console = Console::start(runs.path(), (120, 40));
    console.open_read_only("latest").expect("it opens");
    console.press("esc g x");
    console.assert_shows("leads of S1 on day 14");
    drop(console);
    let folder = run_folder(runs.path());
    let after = read_afterwards(&folder, &read_trajectory(&folder)).expect("lines");
    assert_eq!(inspections(&after), ["leads S1 14"]);
}

#[test]
fn replay_of_a_debug_run_in_use_cannot_be_inspected() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = create_run(runs.path(), Mode::Debug, 2);
    let mut console = console_in_replay(runs.path(), (120, 40), SeekTarget::Week(1));
    console.press("g x");
    assert!(!console.screen().contains("leads of S1 on day"), "{}", console.screen());
    drop(session);
}

#[test]
fn replay_of_an_unfinished_run_cannot_be_inspected() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(create_run(runs.path(), Mode::Sandbox, 2));
    let mut console = console_in_replay(runs.path(), (120, 40), SeekTarget::Week(1));
    console.press("g x");
    console.assert_shows("The x-ray is available in debug runs and in runs that have ended.");
}

/// Types a command on the X-ray screen and sends it.
fn submit_command(console: &mut Console, words: &str) {
    console.press("a");
    console.send(Event::Paste(words.to_owned()));
    console.press("enter");
}

#[test]
fn debug_commands_match_plain_mode_and_are_recorded() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_on_xray_screen(runs.path(), 4, (200, 60));
    let asked =
        ["find leads(S1) >= 1", "who reputation(S1) 20", "diff 27 28", "set", "set group.S1.c_max_mean"];
    let mut screens = Vec::new();
    for words in asked {
        submit_command(&mut console, words);
        screens.push(console.screen());
    }
    console.press("a 'fond' enter");
    console.assert_shows("did you mean find?");
    drop(console);
    let folder = run_folder(runs.path());
    let texts = inspections(&read_trajectory(&folder));
    assert_eq!(texts.len(), 4, "{texts:?}");
    let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
    let shows = |screen: &str, part: &str| assert!(screen.contains(part), "{part:?} is missing in\n{screen}");
    let days =
        session.inspect().find_condition_days("leads(S1) >= 1".parse().expect("a condition")).expect("days");
    shows(&screens[0], &format!("leads(S1) >= 1 became true on {} of 28 days", days.len()));
    let writes = session
        .inspect()
        .figure_writes("reputation(S1)".parse().expect("a figure"), Some(20))
        .expect("writes");
    shows(
        &screens[1],
        &format!("reputation(S1) on day 20: {:.9} → {:.9}", writes.opening_value, writes.closing_value),
    );
    let found = session.inspect().compare_days(27, 28).expect("a difference");
    shows(&screens[2], &format!("differs: {}", found.differing_parts.join(", ")));
    shows(&screens[3], "no parameter differs from");
    let value = session
        .company()
        .debug_parameters()
        .and_then(|debug_parameters| debug_parameters.value("group.S1.c_max_mean"))
        .expect("a value");
    shows(&screens[4], &format!("group.S1.c_max_mean = {value}"));
}

#[test]
fn parameters_are_set_only_in_debug_runs_after_confirmation() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_on_xray_screen(runs.path(), 2, (120, 40));
    let before = console.app.run().map(|run| run.company.observation.day);
    submit_command(&mut console, "set group.S1.c_max_mean 300");
    console.assert_shows("the run will not be ranked");
    console.press("esc");
    submit_command(&mut console, "set group.S1.c_max_mean");
    assert!(!console.screen().contains("= 300"), "{}", console.screen());
    submit_command(&mut console, "set group.S1.c_max_mean 300 from 20");
    console.press("y");
    console.assert_shows("from day 20");
    // Changing the view and returning sends no new request.
    console.press("esc up down");
    console.assert_shows("from day 20");
    assert_eq!(console.app.run().map(|run| run.company.observation.day), before);
    drop(console);
    let is_set = |record: &Record| matches!(record, Record::Override(_));
    let lines = read_trajectory(&run_folder(runs.path()));
    assert_eq!(lines.lines.iter().filter(|line| is_set(&line.record)).count(), 1);

    let runs = tempfile::tempdir().expect("a folder");
    let mut session = create_run(runs.path(), Mode::Sandbox, 2);
    session.abandon().expect("it ends");
    let id = session.manifest().id.clone();
    drop(session);
    let mut console = Console::start(runs.path(), (120, 40));
    console.open(&id).expect("it opens");
    console.press("esc g x");
    submit_command(&mut console, "set group.S1.c_max_mean 300");
    console.press("y");
    console.assert_shows("parameters can be set in debug runs only");
    drop(console);
    let mut console = console_in_replay(runs.path(), (120, 40), SeekTarget::Week(1));
    console.press("g x");
    submit_command(&mut console, "set group.S1.c_max_mean 300");
    console.assert_shows("this is a replay");
}

#[test]
fn hidden_table_queries_are_recorded_as_inspections() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_on_xray_screen(runs.path(), 3, (120, 40));
    console
        .press("9 enter 'SELECT' _ 'count(*)' _ 'AS' _ 'days' _ 'FROM' _ 'hidden.pmi' shift-tab end right");
    let mut complaints = Vec::new();
    let text = snapshot_text(&mut console, &mut complaints);
    insta::assert_snapshot!("xray-sql", text);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    console.press("f5");
    console.assert_shows("Query · x-ray");
    console.assert_shows("Result · x-ray");
    console.assert_shows("21");
    drop(console);
    let texts = inspections(&read_trajectory(&run_folder(runs.path())));
    assert!(texts.contains(&"sql SELECT count(*) AS days FROM hidden.pmi 21".to_owned()), "{texts:?}");
}

#[test]
fn replay_of_a_finished_run_queries_hidden_tables() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = create_run(runs.path(), Mode::Sandbox, 3);
    session.abandon().expect("it ends");
    drop(session);
    let mut console = console_in_replay(runs.path(), (120, 40), SeekTarget::Week(1));
    // The inspection that precedes the query opens the run without its database.
    console.press("g x 9 enter 'SELECT' _ 'max(day)+100' _ 'FROM' _ 'hidden.drift' f5");
    console.assert_shows("121");
    drop(console);
    let folder = run_folder(runs.path());
    let after = read_afterwards(&folder, &read_trajectory(&folder)).expect("lines");
    assert_eq!(inspections(&after), ["leads S1 7", "sql SELECT max(day)+100 FROM hidden.drift 7"]);
}

#[test]
fn hidden_tables_are_unavailable_in_unfinished_non_debug_runs() {
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let runs = tempfile::tempdir().expect("a folder");
        drop(create_run(runs.path(), mode, 1));
        let mut console = Console::in_latest_run(runs.path(), (120, 40));
        console.press("9 enter 'SELECT' _ '*' _ 'FROM' _ 'hidden.groups' f5");
        let screen = console.screen();
        assert!(!screen.contains("x-ray") && !screen.contains("hidden.drift"), "{screen}");
        assert!(!screen.contains("reputation"), "{screen}");
        drop(console);
        let lines = read_trajectory(&run_folder(runs.path()));
        assert_eq!(inspections(&lines), Vec::<String>::new());
    }
}

#[test]
fn replay_opens_on_the_xray_screen_if_permitted() {
    for (ends, title) in [(true, "leads of S1 on day 14"), (false, "Overview")] {
        let runs = tempfile::tempdir().expect("a folder");
        let mut session = create_run(runs.path(), Mode::Sandbox, 2);
        if ends {
            session.abandon().expect("it ends");
        }
        drop(session);
        let mut console = Console::start(runs.path(), (200, 60));
        console.replay_with_xray(RecordSource::Run("latest".to_owned()), SeekTarget::Last).expect("it opens");
        console.assert_shows(title);
        assert_eq!(console.screen().contains("leads of S1"), ends);
    }
}
