//! A finished run: it offers the remaining actions, and no next week.

use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;

use super::harness::Console;
use super::looks::SIZES;
use crate::support::company::{begin_run, open_shop, weeks};

fn over(runs: &std::path::Path, mode: Mode, size: (u16, u16)) -> Console {
    let mut session = begin_run(runs, mode, 98);
    open_shop(&mut session);
    weeks(&mut session, 14);
    assert!(session.ended().is_some());
    let id = session.manifest().id.clone();
    drop(session);
    let mut console = Console::start(runs, size);
    console.open(&id).expect("it opens");
    console
}

#[test]
fn nothing_offers_a_next_week() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = over(runs.path(), Mode::Sandbox, (200, 60));
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
    console.shows("n final page");
    console.press("w");
    console.shows("the run has ended: n final page · ; b what if · ; r write the report");
    console.press("n");
    console.shows("You end with");
}

#[test]
fn a_what_if_of_the_final_page_begins_twelve_weeks_before_the_end() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = over(runs.path(), Mode::Baseline, (120, 40));
    console.shows("b what if");
    console.press("b");
    console.shows("What if, from week 2 ");
    console.press("esc ; b");
    console.shows("What if, from week 2 ");
}

#[test]
fn a_defect_in_background_work_is_reported_in_its_dialog() {
    let runs = tempfile::tempdir().expect("a folder");
    let console = over(runs.path(), Mode::Baseline, (120, 40));
    let id = console.app.run().expect("a run").company.seen.run.clone();
    drop(console);
    let mut settings = Console::settings(Configuration::shipped(), runs.path());
    settings.opponents = |_, _, _| panic!("seat 3 is missing");
    let mut console = Console::of(settings, (120, 40));
    console.open(&id).expect("it opens");
    console.press("o");
    console.shows("internal error (seat 3 is missing); nothing was changed");
    console.press("esc");
    console.shows("You end with");
}

#[test]
fn opponents_play_its_world_and_rank_it() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = over(runs.path(), Mode::Baseline, (120, 40));
    console.shows("o opponents");
    console.press("o");
    for size in SIZES {
        console.size = size;
        for part in ["each policy plays", "▌ You", "enterprise-led", "harvest-late", "baseline"] {
            console.shows(part);
        }
    }
    // The page closes to the final page, and can be opened again.
    console.press("esc");
    console.shows("You end with");
    console.hides("enterprise-led");
    console.press("o");
    console.shows("▌ You");
}

#[test]
fn why_is_asked_about_other_weeks_of_it() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = over(runs.path(), Mode::Sandbox, (120, 40));
    console.press("esc w ; w");
    console.shows("week 14");
    console.press("left left");
    console.shows("week 12");
    console.press("right");
    console.shows("week 13");
}
