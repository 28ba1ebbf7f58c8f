//! True values on the Customers and Market screens: their display, their record, and cases without permission.

use std::path::Path;

use novamind::insight::Inspect;
use novamind::record::mode::Mode;
use novamind::session::{Access, SeekTarget, Session, read_afterwards};
use novamind::world::identifiers::Group;

use super::harness::Console;
use super::picture_checks::snapshot_text;
use super::replay::console_in_replay;
use crate::support::company::{advance_weeks, apply_opening_decisions, begin_run};
use crate::support::record::{inspections, read_trajectory, run_folder};

/// Labels that appear only if true values are shown.
const TRUE_VALUE_LABELS: [&str; 5] =
    ["true sat.", "true rep.", "x-ray, day", "x-ray: true", "true values of"];

fn create_run(runs: &Path, mode: Mode, count: usize) -> Session {
    let mut session = begin_run(runs, mode, 84);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, count);
    session
}

#[test]
fn true_values_are_shown_next_to_estimates() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(create_run(runs.path(), Mode::Debug, 8));
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.press("3 ; o");
    let mut complaints = Vec::new();
    let customers = snapshot_text(&mut console, &mut complaints);
    console.press("7");
    let market = snapshot_text(&mut console, &mut complaints);
    console.press("tab tab tab");
    let news = snapshot_text(&mut console, &mut complaints);
    insta::assert_snapshot!("overlay-customers", customers);
    insta::assert_snapshot!("overlay-market", market);
    insta::assert_snapshot!("overlay-news", news);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    // Hiding removes all true values. Showing the same day again records no second inspection.
    console.press("; o");
    for keys in ["3", "7"] {
        console.press(keys);
        let screen = console.screen();
        assert!(!TRUE_VALUE_LABELS.iter().any(|mark| screen.contains(mark)), "{screen}");
    }
    console.press("; o");
    console.assert_shows("x-ray: true");
    drop(console);
    let folder = run_folder(runs.path());
    assert_eq!(inspections(&read_trajectory(&folder)), ["values  56"]);
    // The displayed values must equal the values of the simulator.
    let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
    let group = Group::parse("S1").expect("a group");
    let group_values = session.inspect().hidden_values(None).expect("values").groups[group];
    let reputation = session.inspect().reputation_equation(group, None).expect("an equation").after;
    assert_eq!(group_values.reputation.to_bits(), reputation.to_bits());
    let leads = session.inspect().lead_equations(group, None).expect("equations");
    let expected = leads.last().map(|lead_equation| lead_equation.expected_leads());
    assert_eq!(Some(group_values.expected_leads), expected);
    let true_satisfaction = session
        .debug_hidden_state()
        .expect("a debug run")
        .mean_satisfaction(group)
        .map(|(satisfaction, _)| satisfaction);
    assert_eq!(group_values.satisfaction, true_satisfaction);
    assert!(customers.contains(&format!("{reputation:.3}")), "{reputation} in\n{customers}");
}

#[test]
fn each_shown_day_is_recorded_as_an_inspection() {
    let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let hashes = [true, false].map(|shows| {
        let runs = folders[usize::from(shows)].path();
        drop(create_run(runs, Mode::Debug, 2));
        let mut console = Console::in_latest_run(runs, (120, 40));
        if shows {
            console.press("3 ; o");
        }
        console.advance_week();
        console.press("esc 3");
        let screen = console.screen();
        assert_eq!(screen.contains("true values of day 21"), shows, "{screen}");
        drop(console);
        let folder = run_folder(runs);
        let texts = inspections(&read_trajectory(&folder));
        assert_eq!(texts.len(), if shows { 2 } else { 0 }, "{texts:?}");
        Session::open(&folder, Access::Read, false).expect("it opens").state_hash()
    });
    assert_eq!(hashes[0], hashes[1]);
}

#[test]
fn overlay_is_unavailable_in_unfinished_non_debug_runs() {
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let runs = tempfile::tempdir().expect("a folder");
        drop(create_run(runs.path(), mode, 2));
        let mut console = Console::in_latest_run(runs.path(), (200, 60));
        for keys in ["3", "; o", "; o", "7", "; o", "tab ; o tab tab", "; o"] {
            console.press(keys);
            let screen = console.screen();
            assert!(
                !TRUE_VALUE_LABELS.iter().any(|mark| screen.contains(mark)),
                "{mode:?}, {keys}:\n{screen}"
            );
        }
        console.assert_shows("the x-ray is available in debug runs and in runs that have ended");
        drop(console);
        let mut console = console_in_replay(runs.path(), (200, 60), SeekTarget::Week(1));
        console.press("3 ; o");
        let screen = console.screen();
        assert!(!TRUE_VALUE_LABELS.iter().any(|mark| screen.contains(mark)), "{mode:?}:\n{screen}");
        drop(console);
        let folder = run_folder(runs.path());
        assert_eq!(inspections(&read_trajectory(&folder)), Vec::<String>::new());
        let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
        assert_eq!(
            session.inspect().hidden_values(None).map(drop).expect_err("refused").code,
            "not_in_this_mode"
        );
    }
}

#[test]
fn overlay_is_available_in_finished_runs_and_replays() {
    for mode in [Mode::Baseline, Mode::Sandbox] {
        let runs = tempfile::tempdir().expect("a folder");
        let mut session = create_run(runs.path(), mode, 3);
        session.abandon().expect("it ends");
        drop(session);
        let mut console = console_in_replay(runs.path(), (120, 40), SeekTarget::Week(2));
        console.press("3 ; o");
        console.assert_shows("true values of day 14");
        drop(console);
        let folder = run_folder(runs.path());
        let after = read_afterwards(&folder, &read_trajectory(&folder)).expect("lines");
        assert_eq!(inspections(&after), ["values  14"]);
    }
}
