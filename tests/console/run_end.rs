//! A finished run offers the remaining actions and no next week.

use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;

use super::harness::Console;
use super::picture_checks::SIZES;
use crate::support::company::{advance_weeks, apply_opening_decisions, begin_run};

fn console_in_finished_run(runs: &std::path::Path, mode: Mode, size: (u16, u16)) -> Console {
    let mut session = begin_run(runs, mode, 98);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, 14);
    assert!(session.ended().is_some());
    let id = session.manifest().id.clone();
    drop(session);
    let mut console = Console::start(runs, size);
    console.open(&id).expect("it opens");
    console
}

#[test]
fn finished_run_offers_no_next_week() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_finished_run(runs.path(), Mode::Sandbox, (200, 60));
    console.press("esc");
    for size in SIZES {
        console.size = size;
        for keys in ["1", "2", "3", "4", "5", "6", "7", "8", "9 esc", "0", "w", "esc"] {
            console.press(keys);
            let screen = console.screen();
            for offer in ["n next week", "Start the next week", "n runs"] {
                assert!(!screen.contains(offer), "{size:?}, {keys}: {offer}\n{screen}");
            }
        }
    }
    console.size = (120, 40);
    console.press("1");
    console.assert_shows("n final page");
    console.press("w");
    console.assert_shows("the run has ended: n final page · ; b what if · ; r write the report");
    console.press("n");
    console.assert_shows("You end with");
}

#[test]
fn final_page_what_if_starts_twelve_weeks_before_the_end() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_finished_run(runs.path(), Mode::Baseline, (120, 40));
    console.assert_shows("b what if");
    console.press("b");
    console.assert_shows("What if, decisions of week 2 ");
    console.press("esc ; b");
    console.assert_shows("What if, decisions of week 2 ");
}

#[test]
fn panic_in_background_work_is_reported_in_its_dialog() {
    let runs = tempfile::tempdir().expect("a folder");
    let console = console_in_finished_run(runs.path(), Mode::Baseline, (120, 40));
    let id = console.app.run().expect("a run").company.observation.run.clone();
    drop(console);
    let mut settings = Console::settings(Configuration::bundled(), runs.path());
    settings.opponents = |_, _, _| panic!("seat 3 is missing");
    let mut console = Console::with_settings(settings, (120, 40));
    console.open(&id).expect("it opens");
    console.press("o");
    console.assert_shows("internal error (seat 3 is missing); nothing was changed");
    console.press("esc");
    console.assert_shows("You end with");
}

#[test]
fn final_page_ranks_the_run_among_policies() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_finished_run(runs.path(), Mode::Baseline, (120, 40));
    console.assert_shows("o opponents");
    console.press("o");
    for size in SIZES {
        console.size = size;
        for part in ["each policy plays", "▌ You", "enterprise-led", "harvest-late", "baseline"] {
            console.assert_shows(part);
        }
    }
    // After the ranking is closed, the final page is shown, and the ranking can be opened again.
    console.press("esc");
    console.assert_shows("You end with");
    console.assert_hides("enterprise-led");
    console.press("o");
    console.assert_shows("▌ You");
}

#[test]
fn causes_of_earlier_weeks_are_shown() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_finished_run(runs.path(), Mode::Sandbox, (120, 40));
    console.press("esc w ; w");
    console.assert_shows("week 14");
    console.press("left left");
    console.assert_shows("week 12");
    console.press("right");
    console.assert_shows("week 13");
}
