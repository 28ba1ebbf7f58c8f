//! The tour and the start menu for a new user.

use novamind::record::folder::runs::list_runs;
use novamind::record::trajectory::record::RunEndReason;

use super::harness::Console;

/// Window sizes in which the tour is played.
const SIZES: [(u16, u16); 4] = [(60, 16), (80, 24), (120, 40), (200, 60)];

/// Places in which a user may be when a step begins: keys from the Overview screen without a dialog.
const PLACES: [&str; 30] = [
    "",
    "tab",
    "tab tab",
    "2 tab",
    "3",
    "3 tab",
    "3 tab tab",
    "3 down right right",
    "3 enter",
    "3 enter tab tab tab",
    "3 / 'S2'",
    "4 tab",
    "5 p 'Hello'",
    "6",
    "7 down",
    "7 v",
    "8",
    "8 enter",
    "8 enter down",
    "8 enter enter '4'",
    "8 down down enter enter",
    "9",
    "9 i 'SELECT'",
    "9 tab tab",
    "0 e 'note'",
    ": 'se'",
    "?",
    "n",
    "n enter 'half'",
    "; v z",
];

/// Maximum number of times that a user reads and follows the keys of a step.
const MAX_ROUNDS: usize = 9;

/// Presses the keys that the tour shows until the step is complete, and returns the number of keys. No key of the tour
/// may be rejected or change the text in the SQL editor.
fn follow_step(console: &mut Console) -> usize {
    let tour = |console: &Console| console.app.run().and_then(|run| run.tour.clone());
    let before = tour(console).expect("a tour").title();
    let draft = console.app.run().expect("a run").screens.sql.draft();
    let mut pressed = 0;
    for _ in 0..MAX_ROUNDS {
        let Some(tour) = tour(console).filter(|tour| tour.title() == before) else { return pressed };
        let shown = console.screen().split_whitespace().collect::<Vec<_>>().join(" ");
        for group in tour.key_groups() {
            assert!(shown.contains(&group.label()), "{} is not shown:\n{}", group.label(), console.screen());
        }
        for group in tour.key_groups() {
            for key in group.notation().split(' ').filter(|key| !key.is_empty()) {
                console.press(key);
                pressed += 1;
                let status = console.app.status.as_ref().filter(|status| status.is_error);
                assert!(status.is_none(), "{key} of {before} is rejected:\n{}", console.screen());
            }
        }
        if before != "Who cancelled" {
            let text = console.app.run().expect("a run").screens.sql.draft();
            assert_eq!(text, draft, "{before} typed into the SQL editor");
        }
    }
    panic!("{before} is not complete:\n{}", console.screen());
}

/// Plays the tour. At the start of each step, the user goes to a place that depends on the step and on `offset`.
fn play_tour(size: (u16, u16), offset: Option<usize>) {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), size);
    console.press("enter");
    let mut step = 0;
    while let Some(title) = console.app.run().and_then(|run| run.tour.as_ref()).map(|tour| tour.title()) {
        if let Some(offset) = offset {
            go_to_overview(&mut console);
            console.press(PLACES[(offset + step) % PLACES.len()]);
            let now = console.app.run().and_then(|run| run.tour.as_ref()).map(|tour| tour.title());
            assert_eq!(now, Some(title), "the step waits for the user");
        }
        follow_step(&mut console);
        step += 1;
        assert!(step <= 15, "{title}:\n{}", console.screen());
    }
    assert_eq!(step, 15);
    console.assert_shows("tour completed; you can play on until day 84");
}

/// Closes all dialogs and fields, and shows the Overview screen.
fn go_to_overview(console: &mut Console) {
    for _ in 0..8 {
        let is_typing = console.app.scopes().first().is_some_and(|scope| scope.is_text());
        if console.app.layers.is_empty() && !is_typing {
            break;
        }
        console.press("esc");
    }
    console.press("g o");
    assert!(console.app.layers.is_empty(), "{}", console.screen());
}

#[test]
fn tour_keys_complete_every_step() {
    for size in [SIZES[0], SIZES[3]] {
        play_tour(size, None);
    }
}

#[test]
fn tour_keys_work_from_other_places() {
    play_tour(SIZES[1], Some(0));
    play_tour(SIZES[2], Some(15));
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn tour_keys_work_from_every_place() {
    for offset in 0..PLACES.len() {
        play_tour(SIZES[offset % SIZES.len()], Some(offset));
    }
}

/// Follows the tour until a step begins.
fn follow_until(console: &mut Console, title: &str) {
    while console.app.run().and_then(|run| run.tour.as_ref()).expect("a tour").title() != title {
        follow_step(console);
    }
}

#[test]
fn tour_shows_a_cancellation_with_its_reason_a_why_and_a_what_if() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (120, 40));
    console.press("enter");
    console.assert_shows("day 0/84");
    follow_until(&mut console, "The curve");
    console.press("; v");
    console.assert_shows("Participation curve of S1");
    console.assert_shows("f3 continue");
    follow_until(&mut console, "Who cancelled");
    console.assert_shows("subscribers cancelled in week 5");
    console.press("esc : 'their' _ 'issues' enter");
    console.assert_shows("open_issues");
    console.assert_shows("f3 continue");
    follow_until(&mut console, "Why");
    console.press("esc n f enter esc");
    let keys: Vec<String> = console
        .app
        .run()
        .and_then(|run| run.tour.as_ref())
        .expect("a tour")
        .key_groups()
        .iter()
        .map(|group| group.notation())
        .filter(|keys| keys != "f3")
        .collect();
    console.press(&keys.join(" "));
    console.assert_shows("cancellations of S1, week 6");
    console.assert_shows("operations: 0 → 300 $/day");
    console.press("f3 esc ; b x ctrl-s");
    console.assert_shows("daily");
    console.assert_shows("after week");
    console.assert_shows("f3 continue");
}

#[test]
fn tour_waits_for_the_user_and_resumes() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (80, 24));
    console.assert_shows("New here?");
    console.press("enter");
    console.assert_shows("Tour · 1 of 15 · The idea");
    console.press("3 enter tab 8 1");
    console.assert_shows("Tour · 1 of 15 · The idea");
    console.press("f3");
    console.assert_shows("Tour · 2 of 15 · The curve");
    console.press("; v esc");
    console.assert_shows("Tour · 2 of 15 · The curve");
    console.press("f3");
    console.assert_shows("Tour · 3 of 15 · Fit");
    console.press("f3");
    console.assert_shows("this step is not done");
    console.assert_shows("Tour · 3 of 15 · Fit");
    console.press("3");
    console.assert_shows("Fit of S1");
    console.press("f3");
    console.assert_shows("Tour · 4 of 15 · A price");
    console.press("8 enter enter '7' enter ctrl-s");
    console.assert_shows("Tour · 5 of 15 · A model");
    console.press("f4");
    assert!(!console.screen().contains("Tour ·"), "it is closed");
    console.press("1 : 'tour' enter");
    console.assert_shows("Tour · 5 of 15 · A model");
    // The tour resumes from the start menu at the step where it was left.
    console.press("q");
    drop(console);
    let mut console = Console::start(runs.path(), (80, 24));
    console.assert_shows("Continues its run");
    console.press("down down down down enter");
    console.assert_shows("Tour · 5 of 15 · A model");
    while console.app.run().is_some_and(|run| run.tour.is_some()) {
        follow_step(&mut console);
    }
    assert!(!console.screen().contains("Tour ·"), "it is complete");
    console.assert_shows("tour completed; you can play on until day 84");
    assert_eq!(list_runs(runs.path()).expect("a list").len(), 1);
}

#[test]
fn tour_is_offered_only_in_its_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press(": 'tour' enter");
    console.assert_shows("the tour has its own run");
}

#[test]
fn baseline_run_has_explanations_but_no_tour() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (120, 40));
    console.press("n up up up up up up left down down down down down enter 'P01' enter down enter");
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
