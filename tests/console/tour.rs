//! The tour and the start menu for a new user.

use novamind::record::folder::runs::list_runs;
use novamind::record::trajectory::record::RunEndReason;

use super::harness::Console;

#[test]
fn tour_advances_by_actions_and_resumes() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (80, 24));
    console.assert_shows("New here?");
    console.press("enter");
    console.assert_shows("Tour · 1 of 18 · The idea");
    console.assert_shows("day 0/84");
    console.press("3");
    console.assert_shows("Tour · 2 of 18 · Required quality");
    console.press("down enter");
    console.assert_shows("Tour · 3 of 18 · A price");
    console.press("8 enter down enter '45' enter ctrl-s");
    console.assert_shows("Tour · 4 of 18 · A model");
    console.press("f4 esc");
    assert!(!console.screen().contains("Tour ·"), "it is closed");
    console.press("1 : 'tour' enter");
    console.assert_shows("Tour · 4 of 18 · A model");
    // The tour resumes from the start menu at the step where it was left.
    console.press("q");
    drop(console);
    let mut console = Console::start(runs.path(), (80, 24));
    console.assert_shows("Continues the practice run");
    console.press("down down down down enter");
    console.assert_shows("Tour · 4 of 18 · A model");
    console.press("f3 f3 f3 f3");
    console.assert_shows("Tour · 8 of 18 · A week");
    console.press("n");
    console.assert_shows("Tour · 9 of 18 · Why");
    console.press("enter 'curious' enter");
    console.assert_shows("Tour · 10 of 18 · Forecasts");
    console.press("f enter");
    console.assert_shows("Tour · 11 of 18 · Report");
    console.press("esc");
    console.assert_shows("Tour · 12 of 18 · Who signed");
    console.press("f3 f3 f3 f3 f3");
    console.assert_shows("Tour · 17 of 18 · Who buys");
    console.press("f3 f3");
    assert!(!console.screen().contains("Tour ·"), "it is complete");
    console.assert_shows("tour completed; you can play on until day 84");
    assert_eq!(list_runs(runs.path()).expect("a list").len(), 1);
}

#[test]
fn tour_is_offered_only_in_practice() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press(": 'tour' enter");
    console.assert_shows("the tour has its own run");
}

#[test]
fn baseline_run_has_explanations_but_no_tour() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (120, 40));
    console.press("n up up up up up up left down down down down down 'P01' down enter");
    console.assert_shows("BASELINE");
    console.press(": 'tour' enter");
    console.assert_shows("baseline runs have no tour");
    console.press(": 'glossary' enter");
    console.assert_shows("Glossary");
    console.press("/ 'word' _ 'of' _ 'mouth' enter enter");
    console.assert_shows("see also");
    console.assert_shows("Word of mouth");
    console.press("enter");
    console.assert_shows("Referral");
    console.press("backspace");
    console.assert_shows("Word of mouth");
    console.press("esc esc esc f2");
    console.assert_shows("see also");
}

#[test]
fn start_menu_compares_abandons_and_deletes_runs() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.advance_week();
    console.press("esc");
    console.press(": 'start' _ 'menu' enter");
    console.assert_shows("Last run");
    console.press("n enter");
    console.assert_shows("day 0/500");
    console.press(": 'start' _ 'menu' enter");
    console.press("down down enter");
    console.assert_shows("Run ");
    console.press("_ _ v");
    console.assert_shows("Current figures");
    console.press("esc x");
    console.assert_shows("without a score");
    console.press("y");
    console.assert_shows("has been ended");
    let list = list_runs(runs.path()).expect("a list");
    assert_eq!(list.iter().filter(|run| run.ended == Some(RunEndReason::Abandoned)).count(), 1);
    console.press("D esc D y");
    console.assert_shows("has been deleted");
    assert_eq!(list_runs(runs.path()).expect("a list").len(), 1);
}
