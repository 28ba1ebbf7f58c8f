//! A lesson on the screen: the task, a guess, hints, weeks at one key, another try, the debrief.

use std::path::Path;

use novamind::session::{Access, Configuration, Session, find_run};

use super::harness::Console;
use super::looks;

/// A window with the task beside the screen, and one in which it is a page.
const WIDE: (u16, u16) = (120, 40);
const SMALL: (u16, u16) = (80, 24);

/// A person who has a lesson of two weeks.
fn configuration(folder: &Path) -> Configuration {
    let lessons = folder.join("lessons");
    std::fs::create_dir_all(&lessons).expect("a folder");
    for file in ["two-weeks.toml", "two-weeks.md"] {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/lessons").join(file);
        std::fs::copy(from, lessons.join(file)).expect("a copy");
    }
    Configuration { folder: Some(folder.to_owned()) }
}

/// A console in the lesson, which the start menu began.
fn in_lesson(folder: &Path, size: (u16, u16)) -> Console {
    let mut console = Console::start_with(configuration(&folder.join("own")), &folder.join("runs"), size);
    open_lessons(&mut console);
    console.press("end");
    console.shows("Two weeks");
    console.press("enter");
    console
}

/// The page of lessons of the start menu.
fn open_lessons(console: &mut Console) {
    for _ in 0..9 {
        if console.screen().contains("› Lessons") {
            break;
        }
        console.press("down");
    }
    console.press("enter");
    console.shows(" lessons ");
}

#[test]
fn a_lesson_is_played_to_its_end_beside_the_screen() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = in_lesson(folder.path(), WIDE);
    console.shows("Step 1 of 2: Open the shop");
    console.shows("hints 0/2");
    // The question comes before the week.
    console.press("n");
    console.shows("What share of the leads will buy?");
    console.press("enter");
    console.shows("type a number");
    console.press("'0.5' enter");
    console.shows("You guessed 50%");
    console.press("; l h");
    console.shows("Hint 1: Look at the leads.");
    console.press("esc n");
    // One key was the week; what it came to stands beside the screen, with the pitfall and the next task.
    console.shows("Step 1 is over: Open the shop");
    console.shows("reached: One subscriber");
    console.shows("! Day 7: Somebody bought.");
    console.shows("Step 2 of 2: Go on");
    assert_eq!(console.app.run().expect("a run").company.seen.day, 7);
    console.press("n");
    console.shows("1 Cash");
    console.press("2 enter n");
    console.shows("Debrief");
    for said in ["You had ", "the good play", "set_prices: A 20, the good play 12"] {
        console.shows(said);
    }
    console.press("G");
    console.shows("Conversion");
    console.press("r");
    let run = console.app.run().expect("a run").company.folder.clone().expect("a folder");
    for file in ["debrief.md", "debrief.html"] {
        assert!(run.join(file).is_file(), "{file}");
    }
    // Another try of the last step asks first, and is a run of its own.
    console.press("a");
    console.shows("begins again");
    console.press("y");
    console.shows("Step 2 of 2: Go on, try 2");
    assert_eq!(console.app.run().expect("a run").company.seen.day, 7);
    assert_ne!(console.app.run().expect("a run").company.folder, Some(run));
}

#[test]
fn in_a_small_window_the_task_is_a_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = in_lesson(folder.path(), SMALL);
    console.shows("Step 1 of 2: Open the shop");
    console.press("esc");
    assert!(!console.screen().contains("Step 1 of 2"));
    console.press("; h");
    console.shows("Step 1 of 2: Open the shop");
    console.press("enter '0.4' enter");
    console.shows("You guessed 40%");
    console.press("n");
    console.shows("Step 1 is over: Open the shop");
    console.press("esc n 2 enter n");
    console.shows("Debrief");
    console.press("esc n");
    console.shows("Debrief");
}

#[test]
fn the_task_beside_the_screen_can_be_hidden() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = in_lesson(folder.path(), WIDE);
    console.shows("Step 1 of 2");
    console.press("; h");
    assert!(!console.screen().contains("Step 1 of 2"));
    console.press("; h");
    console.shows("Step 1 of 2");
}

#[test]
fn what_is_not_in_the_lesson_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = in_lesson(folder.path(), WIDE);
    console.press("3");
    console.shows("Customers is not in this lesson; it has Overview, Cash");
    console.press("8");
    console.shows("locked");
    console.press(": 'set_daily_spend'");
    console.shows("not in this lesson");
    console.press("enter");
    console.shows("Not in this lesson.");
}

#[test]
fn a_guess_and_hints_outlive_the_program() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = in_lesson(folder.path(), WIDE);
    console.press("n '0.25' enter ; l h h");
    drop(console);
    let runs = folder.path().join("runs");
    let mut console = Console::in_latest_run(&runs, WIDE);
    for said in ["You guessed 25%", "Hint 2: Try another price.", "hints 2/2"] {
        console.shows(said);
    }
    let run = console.app.run().expect("a run").company.folder.clone().expect("a folder");
    drop(console);
    let session = Session::open(&run, Access::Read, false).expect("it opens");
    assert_eq!(session.lesson().map(|own| (own.guess(0), own.hints(0))), Some((Some(0.25), 2)));
    assert!(find_run(&runs, "latest").is_ok());
}

/// Takes a picture of what is shown, in windows of all sizes.
fn picture(console: &mut Console, place: &str) {
    let mut complaints = Vec::new();
    insta::assert_snapshot!(format!("lesson-{place}"), looks::picture(console, &mut complaints));
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn pictures_of_a_lesson() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = in_lesson(folder.path(), WIDE);
    picture(&mut console, "task");
    console.press("n");
    picture(&mut console, "question");
    console.press("'40%' enter ; l h");
    picture(&mut console, "page");
    console.press("esc 8");
    picture(&mut console, "tools");
}

#[test]
fn a_part_leads_to_the_next_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(folder.path(), WIDE);
    open_lessons(&mut console);
    console.press("enter n '0.4' enter n");
    console.shows("This part is over: p next part");
    console.shows("You guessed 40%.");
    // What the good play does would give the next part away.
    console.press("d");
    console.shows("Debrief");
    assert!(!console.screen().contains("The good play:"));
    console.press("p");
    assert_eq!(
        console.app.run().and_then(|run| run.company.lesson.clone()).and_then(|own| own.next_part),
        None
    );
    console.shows("hints 0/3");
    assert_eq!(console.app.run().expect("a run").company.seen.day, 0);
}

#[test]
fn a_price_that_was_typed_and_not_sent_is_asked_about() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = in_lesson(folder.path(), WIDE);
    console.press("n '0.4' enter : 'set_prices' enter e '30' enter n");
    console.shows("The form of set_prices holds values that were not sent");
    console.press("esc");
    assert_eq!(console.app.run().expect("a run").company.seen.day, 0);
    console.press("n y");
    assert_eq!(console.app.run().expect("a run").company.seen.day, 7);
}

#[test]
fn pictures_of_a_debrief() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = in_lesson(folder.path(), WIDE);
    console.press("n '0.25' enter n");
    picture(&mut console, "next-step");
    console.press("n 2 enter n");
    picture(&mut console, "debrief");
    console.press("a");
    picture(&mut console, "again");
}

#[test]
fn runs_of_no_lesson_say_so() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), WIDE);
    console.press("; h");
    console.shows("this run belongs to no lesson");
    console.press("; l");
    console.shows("this run belongs to no lesson");
}
