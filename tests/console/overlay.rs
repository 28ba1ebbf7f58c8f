//! True values on the Customers and Market screens: their display, their record, and cases without permission.

use std::path::Path;

use novamind::insight::Inspect;
use novamind::record::mode::Mode;
use novamind::session::{Access, Goal, Session, lines_afterwards};
use novamind::world::identifiers::Group;

use super::harness::Console;
use super::looks::picture;
use super::replay::replayed;
use crate::support::company::{begin_run, open_shop, weeks};
use crate::support::record::{folder_of, looks, recorded};

/// Texts that appear with true values.
const MARKS: [&str; 5] = ["true sat.", "true rep.", "x-ray, day", "x-ray: true", "true values of"];

fn run(runs: &Path, mode: Mode, count: usize) -> Session {
    let mut session = begin_run(runs, mode, 84);
    open_shop(&mut session);
    weeks(&mut session, count);
    session
}

#[test]
fn true_values_stand_beside_figures_and_estimates() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(run(runs.path(), Mode::Debug, 8));
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.press("3 ; o");
    let mut complaints = Vec::new();
    let customers = picture(&mut console, &mut complaints);
    console.press("7");
    let market = picture(&mut console, &mut complaints);
    console.press("tab tab tab");
    let news = picture(&mut console, &mut complaints);
    insta::assert_snapshot!("overlay-customers", customers);
    insta::assert_snapshot!("overlay-market", market);
    insta::assert_snapshot!("overlay-news", news);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    // Hiding removes everything, and showing the same day again records no second inspection.
    console.press("; o");
    for keys in ["3", "7"] {
        console.press(keys);
        let screen = console.screen();
        assert!(!MARKS.iter().any(|mark| screen.contains(mark)), "{screen}");
    }
    console.press("; o");
    console.shows("x-ray: true");
    drop(console);
    let folder = folder_of(runs.path());
    assert_eq!(looks(&recorded(&folder)), ["values  56"]);
    // The displayed values are those of the simulator.
    let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
    let group = Group::parse("S1").expect("a group");
    let own = session.inspect().hidden_values(None).expect("values").groups[group];
    let reputation = session.inspect().reputation_equation(group, None).expect("an equation").after;
    assert_eq!(own.reputation.to_bits(), reputation.to_bits());
    let leads = session.inspect().lead_equations(group, None).expect("equations");
    let expected = leads.last().map(|own| own.expected());
    assert_eq!(Some(own.expected_leads), expected);
    let mood = session.xray().expect("a debug run").mood(group).map(|(satisfaction, _)| satisfaction);
    assert_eq!(own.satisfaction, mood);
    assert!(customers.contains(&format!("{reputation:.3}")), "{reputation} in\n{customers}");
}

#[test]
fn each_day_that_is_shown_is_a_look_and_changes_no_hash() {
    let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let hashes = [true, false].map(|shows| {
        let runs = folders[usize::from(shows)].path();
        drop(run(runs, Mode::Debug, 2));
        let mut console = Console::in_latest_run(runs, (120, 40));
        if shows {
            console.press("3 ; o");
        }
        console.week();
        console.press("esc 3");
        let screen = console.screen();
        assert_eq!(screen.contains("true values of day 21"), shows, "{screen}");
        drop(console);
        let folder = folder_of(runs);
        let told = looks(&recorded(&folder));
        assert_eq!(told.len(), if shows { 2 } else { 0 }, "{told:?}");
        Session::open(&folder, Access::Read, false).expect("it opens").state_hash()
    });
    assert_eq!(hashes[0], hashes[1]);
}

#[test]
fn an_unfinished_run_of_another_mode_shows_nothing_of_it() {
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let runs = tempfile::tempdir().expect("a folder");
        drop(run(runs.path(), mode, 2));
        let mut console = Console::in_latest_run(runs.path(), (200, 60));
        for keys in ["3", "; o", "; o", "7", "; o", "tab ; o tab tab", "; o"] {
            console.press(keys);
            let screen = console.screen();
            assert!(!MARKS.iter().any(|mark| screen.contains(mark)), "{mode:?}, {keys}:\n{screen}");
        }
        console.shows("the x-ray works in debug runs and in runs that are over");
        drop(console);
        let mut console = replayed(runs.path(), (200, 60), Goal::Week(1));
        console.press("3 ; o");
        let screen = console.screen();
        assert!(!MARKS.iter().any(|mark| screen.contains(mark)), "{mode:?}:\n{screen}");
        drop(console);
        let folder = folder_of(runs.path());
        assert_eq!(looks(&recorded(&folder)), Vec::<String>::new());
        let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
        assert_eq!(
            session.inspect().hidden_values(None).map(drop).expect_err("refused").code,
            "not_in_this_mode"
        );
    }
}

#[test]
fn a_run_that_is_over_shows_it_in_any_mode_and_in_its_replay() {
    for mode in [Mode::Baseline, Mode::Sandbox] {
        let runs = tempfile::tempdir().expect("a folder");
        let mut session = run(runs.path(), mode, 3);
        session.end().expect("it ends");
        drop(session);
        let mut console = replayed(runs.path(), (120, 40), Goal::Week(2));
        console.press("3 ; o");
        console.shows("true values of day 14");
        drop(console);
        let folder = folder_of(runs.path());
        let after = lines_afterwards(&folder, &recorded(&folder)).expect("lines");
        assert_eq!(looks(&after), ["values  14"]);
    }
}
