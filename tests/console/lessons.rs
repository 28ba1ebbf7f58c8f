//! Lessons: the task, guesses, hints, weeks without a confirmation, retries and the debrief.

use std::path::Path;

use novamind::record::folder::configuration::Configuration;
use novamind::record::folder::runs::find_run;
use novamind::session::{Access, Session};
use novamind::tools::ToolId;

use super::harness::Console;
use super::picture_checks;

/// Window sizes: wide with the task next to the screen, small with the task as a page.
const WIDE: (u16, u16) = (120, 40);
const SMALL: (u16, u16) = (80, 24);

/// Returns a configuration with a lesson of two weeks.
fn configuration(folder: &Path) -> Configuration {
    let lessons = folder.join("lessons");
    std::fs::create_dir_all(&lessons).expect("a folder");
    for file in ["two-weeks.toml", "two-weeks.md"] {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/lessons").join(file);
        std::fs::copy(from, lessons.join(file)).expect("a copy");
    }
    Configuration { folder: Some(folder.to_owned()), voice: None }
}

/// Returns a configuration with a lesson that is defined by `plan`.
fn configuration_with(folder: &Path, plan: &str) -> Configuration {
    let configuration = configuration(folder);
    std::fs::write(folder.join("lessons/two-weeks.toml"), plan).expect("a plan");
    configuration
}

/// Returns the definition of the two-week lesson, with replacements.
fn two_week_lesson(changes: &[(&str, &str)]) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/lessons/two-weeks.toml");
    let plan = std::fs::read_to_string(path).expect("a plan");
    changes.iter().fold(plan, |plan, (old, new)| {
        assert!(plan.contains(old), "{old}");
        plan.replacen(old, new, 1)
    })
}

/// Opens the lesson from the start menu.
fn console_in_lesson(folder: &Path, size: (u16, u16)) -> Console {
    console_in_lesson_with(configuration(&folder.join("own")), folder, size)
}

fn console_in_lesson_with(configuration: Configuration, folder: &Path, size: (u16, u16)) -> Console {
    let mut console = Console::start_with(configuration, &folder.join("runs"), size);
    open_lessons(&mut console);
    console.press("end");
    console.assert_shows("Two weeks");
    console.press("enter");
    console
}

/// Opens the lessons page of the start menu.
fn open_lessons(console: &mut Console) {
    for _ in 0..9 {
        if console.screen().contains("› Lessons") {
            break;
        }
        console.press("down");
    }
    console.press("enter");
    console.assert_shows(" lessons ");
}

#[test]
fn lesson_is_played_to_its_end_with_the_task_pane() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = console_in_lesson(folder.path(), WIDE);
    console.assert_shows("Step 1 of 2: Open the shop");
    console.assert_shows("hints 0/2");
    // The question must be answered before the week runs.
    console.press("n");
    console.assert_shows("What share of the leads will buy?");
    console.press("enter");
    console.assert_shows("enter a share from 0 to 1");
    console.press("'0.5' enter");
    console.assert_shows("You guessed 50%");
    console.press("; l h");
    console.assert_shows("Hint 1: Look at the leads.");
    console.press("esc n");
    // One key ran the week. The outcome, the pitfall and the next task are shown next to the screen.
    console.assert_shows("Step 1 is complete: Open the shop");
    console.assert_shows("reached: One subscriber");
    console.assert_shows("! Day 7: Somebody bought.");
    console.assert_shows("Step 2 of 2: Go on");
    assert_eq!(console.app.run().expect("a run").company.observation.day, 7);
    console.press("n");
    console.assert_shows("1 Cash");
    console.press("2 enter n");
    console.assert_shows("Debrief");
    for text in ["You had ", "the reference play", "set_prices: A 20, reference play 12"] {
        console.assert_shows(text);
    }
    console.press("G");
    console.assert_shows("Conversion");
    console.press("r");
    let run = console.app.run().expect("a run").company.folder.clone().expect("a folder");
    for file in ["debrief.md", "debrief.html"] {
        assert!(run.join(file).is_file(), "{file}");
    }
    // A retry of the last step asks for confirmation and creates a run.
    console.press("a");
    console.assert_shows("starts again");
    console.press("y");
    console.assert_shows("Step 2 of 2: Go on, try 2");
    assert_eq!(console.app.run().expect("a run").company.observation.day, 7);
    assert_ne!(console.app.run().expect("a run").company.folder, Some(run));
}

#[test]
fn task_is_a_page_in_small_windows() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = console_in_lesson(folder.path(), SMALL);
    console.assert_shows("Step 1 of 2: Open the shop");
    console.press("esc");
    assert!(!console.screen().contains("Step 1 of 2"));
    console.press("; h");
    console.assert_shows("Step 1 of 2: Open the shop");
    console.assert_shows("hints 0/2");
    console.press("; h");
    assert!(!console.screen().contains("Step 1 of 2"));
    console.press("; h");
    console.assert_shows("hints 0/2");
    console.press("enter '0.4' enter");
    console.assert_shows("You guessed 40%");
    console.press("n");
    console.assert_shows("Step 1 is complete: Open the shop");
    console.press("esc n 2 enter n");
    console.assert_shows("Debrief");
    console.press("esc n");
    console.assert_shows("Debrief");
}

#[test]
fn console_locks_the_tools_that_the_lesson_rejects() {
    let folder = tempfile::tempdir().expect("a folder");
    let console = console_in_lesson(folder.path(), WIDE);
    let company = &console.app.run().expect("a run").company;
    let shown: Vec<(ToolId, bool)> = ToolId::all().map(|tool| (tool, company.has_tool(tool))).collect();
    let run = company.folder.clone().expect("a folder");
    drop(console);
    let session = Session::open(&run, Access::Read, false).expect("it opens");
    let lesson = session.lesson().expect("a lesson");
    for (tool, is_available) in shown {
        assert_eq!(is_available, tool == ToolId::NextWeek || lesson.has_tool(tool), "{tool}");
    }
}

#[test]
fn task_pane_can_be_hidden() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = console_in_lesson(folder.path(), WIDE);
    console.assert_shows("Step 1 of 2");
    console.press("; h");
    assert!(!console.screen().contains("Step 1 of 2"));
    console.press("; h");
    console.assert_shows("Step 1 of 2");
}

#[test]
fn locked_features_show_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = console_in_lesson(folder.path(), WIDE);
    console.press("3");
    console.assert_shows("Customers is closed in this lesson; open screens: Overview, Cash");
    console.press("8");
    console.assert_shows("locked");
    console.press(": 'set_daily_spend'");
    console.assert_shows("not in this lesson");
    console.press("enter");
    console.assert_shows("Not in this lesson.");
    // A locked tool cannot be sent, so its draft does not delay the week.
    console.press("n '0.25' enter enter '900' enter");
    console.assert_shows("0 → 900");
    console.press("esc n");
    console.assert_shows("day 7/500");
}

#[test]
fn guesses_and_hints_survive_a_restart() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = console_in_lesson(folder.path(), WIDE);
    console.press("n '0.25' enter ; l h h");
    drop(console);
    let runs = folder.path().join("runs");
    let mut console = Console::in_latest_run(&runs, WIDE);
    for text in ["You guessed 25%", "Hint 2: Try another price.", "hints 2/2"] {
        console.assert_shows(text);
    }
    let run = console.app.run().expect("a run").company.folder.clone().expect("a folder");
    drop(console);
    let session = Session::open(&run, Access::Read, false).expect("it opens");
    assert_eq!(
        session.lesson().map(|lesson_progress| (lesson_progress.guess(0), lesson_progress.hint_count(0))),
        Some((Some(0.25), 2))
    );
    assert!(find_run(&runs, "latest").is_ok());
}

/// Compares the screen with snapshots in windows of all sizes.
fn assert_lesson_snapshots(console: &mut Console, place: &str) {
    let mut complaints = Vec::new();
    insta::assert_snapshot!(
        format!("lesson-{place}"),
        picture_checks::snapshot_text(console, &mut complaints)
    );
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn lesson_matches_snapshots() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = console_in_lesson(folder.path(), WIDE);
    assert_lesson_snapshots(&mut console, "task");
    console.press("n");
    assert_lesson_snapshots(&mut console, "question");
    console.press("'40%' enter ; l h");
    assert_lesson_snapshots(&mut console, "page");
    console.press("esc 8");
    assert_lesson_snapshots(&mut console, "tools");
}

#[test]
fn finished_part_continues_with_the_next_part() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(folder.path(), WIDE);
    open_lessons(&mut console);
    console.press("enter n '0.4' enter n");
    console.assert_shows("This part has ended: p next part");
    console.assert_shows("You guessed 40%.");
    // The reference play is hidden, because it would reveal the solution of the next part.
    console.press("d");
    console.assert_shows("Debrief");
    assert!(!console.screen().contains("The reference play:"));
    console.press("p");
    assert_eq!(
        console
            .app
            .run()
            .and_then(|run| run.company.lesson.clone())
            .and_then(|lesson_status| lesson_status.next_part),
        None
    );
    console.assert_shows("hints 0/3");
    assert_eq!(console.app.run().expect("a run").company.observation.day, 0);
}

#[test]
fn unsent_price_is_confirmed_before_the_week() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = console_in_lesson(folder.path(), WIDE);
    console.press("n '0.4' enter : 'set_prices' enter e '30' enter n");
    console.assert_shows("The form of set_prices has unsubmitted values");
    console.press("esc");
    assert_eq!(console.app.run().expect("a run").company.observation.day, 0);
    console.press("n y");
    assert_eq!(console.app.run().expect("a run").company.observation.day, 7);
}

#[test]
fn step_without_a_question_confirms_before_its_first_week() {
    let folder = tempfile::tempdir().expect("a folder");
    let guess = "[part.step.guess]\nquestion = \"What will there be more of?\"\nchoices = [\"Cash\", \"Subscribers\"]\nanswer = 2\n";
    let plan =
        two_week_lesson(&[(guess, ""), ("weeks = 1\nhints = [\"Wait.\"]", "weeks = 2\nhints = [\"Wait.\"]")]);
    let configuration = configuration_with(&folder.path().join("own"), &plan);
    let mut console = console_in_lesson_with(configuration, folder.path(), WIDE);
    console.press("n '0.4' enter n n");
    console.assert_shows("Step 2 starts: Go on, 2 weeks. Run its first week?");
    // A key that was pressed by accident only cancels the week, and a message reports the cancellation.
    console.press("n");
    console.assert_shows("Step 2: cancelled; y confirms");
    let day = |console: &Console| console.app.run().expect("a run").company.observation.day;
    assert_eq!(day(&console), 7);
    console.press("n y");
    assert_eq!(day(&console), 14);
    console.press("n");
    console.assert_shows("Debrief");
    assert_eq!(day(&console), 21);
}

#[test]
fn sent_rules_are_offered_again_each_week() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = two_week_lesson(&[
        (
            "tools = [\"set_prices\", \"query\"]",
            "tools = [\"send_enterprise_deal\", \"reject_enterprise_deal\", \"query\"]",
        ),
        ("\"market\"]", "\"inbox\"]"),
        ("seed = 1\n", "seed = 1\ncash = 20_000_000\nstart_weeks = 4\n"),
        (
            "{\"targeted_spend\": {\"content_marketing\": {\"S1\": 2000}}}',",
            "{\"targeted_spend\": {\"content_marketing\": {\"E1\": 4000}, \"social_media\": {\"E2\": 4000}}}',
    'set_targeted_dev_spend {\"targeted_spend\": {\"E1\": 5000, \"E2\": 6000}}',",
        ),
        ("weeks = 1\nhints = [\"Look", "weeks = 3\nhints = [\"Look"),
        (
            "week = 0\ncalls = ['set_prices {\"A\": 12, \"B\": 12, \"C\": 12}']",
            "week = 4\ncalls = ['rules: offer rest: C 12']",
        ),
        (
            "week = 0\ncalls = ['set_prices {\"A\": 200, \"B\": 200, \"C\": 200}']",
            "week = 4\ncalls = ['rules: offer rest: C 200']",
        ),
    ]);
    let configuration = configuration_with(&folder.path().join("own"), &plan);
    let mut console = console_in_lesson_with(configuration, folder.path(), WIDE);
    let waiting = |console: &Console| console.app.run().expect("a run").company.observation.waiting.len();
    let day = |console: &Console| console.app.run().expect("a run").company.observation.day;
    assert!(waiting(&console) > 0, "waiting messages");
    console.press("n '0.4' enter 6 R ctrl-n 'offer_rest:_C_19'");
    console.assert_shows("ctrl-n clear the line");
    console.press("ctrl-s n");
    console.assert_shows("send by rules: cancelled");
    console.press("ctrl-s y");
    assert_eq!(waiting(&console), 0);
    console.press("n");
    assert_eq!(day(&console), 35, "no enterprise waits: the week runs at once");
    assert!(waiting(&console) > 0, "more waiting messages");
    console.press("n");
    console.assert_shows("Answer with the rules that you sent last");
    console.press("y");
    assert_eq!(day(&console), 42);
    let run = console.app.run().expect("a run").company.folder.clone().expect("a folder");
    let record = std::fs::read_to_string(run.join("trajectory.jsonl")).expect("a record");
    let sent = record.lines().filter(|line| line.contains("\"tool\":\"send_enterprise_deal\"")).count();
    assert_eq!(sent, 2, "once by the player, once with the week");
    // The third choice runs the week without answers to enterprises.
    let before = waiting(&console);
    assert!(before > 0, "waiting messages");
    console.press("n w");
    assert_eq!(day(&console), 49);
}

#[test]
fn debrief_matches_snapshots() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut console = console_in_lesson(folder.path(), WIDE);
    console.press("n '0.25' enter n");
    assert_lesson_snapshots(&mut console, "next-step");
    console.press("n 2 enter n");
    assert_lesson_snapshots(&mut console, "debrief");
    console.press("a");
    assert_lesson_snapshots(&mut console, "again");
}

#[test]
fn runs_without_a_lesson_show_a_message() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), WIDE);
    console.press("; h");
    console.assert_shows("this run is not part of a lesson");
    console.press("; l");
    console.assert_shows("this run is not part of a lesson");
}
