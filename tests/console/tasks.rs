//! Everyday tasks, key by key, in a usual and in a large window: every key has an effect, none is rejected, and no
//! task needs more keys than stated.

use std::path::Path;

use novamind::record::folder::runs::list_runs;
use novamind::session::verify;
use serde_json::{Value, json};
use tempfile::TempDir;

use super::company::led;
use super::harness::Console;

/// Window sizes of the tasks.
const SIZES: [(u16, u16); 2] = [(80, 24), (120, 40)];

/// Keys of each step of the tour: those that its texts name, and a statement and a sentence to type.
const TOUR: [(&str, &str); 18] = [
    ("The idea", "3"),
    ("What they want", "down enter"),
    ("A price", "8 enter down enter '45' enter ctrl-s"),
    ("A model", "down enter down enter '2' enter ctrl-s"),
    ("A quota", "down enter down enter '400' enter ctrl-s"),
    ("Operations", "down down enter enter '160' enter ctrl-s"),
    ("Leads", "down enter right enter '700' enter ctrl-s"),
    ("A week", "n"),
    ("Why", "enter 'A_first_try.' enter"),
    ("Forecasts", "f enter"),
    ("Report", "esc"),
    ("Who signed", "3"),
    ("Fix it", "1 enter ctrl-s"),
    ("Development", "3 down enter enter '1100' enter ctrl-s"),
    ("The second week", "n f enter"),
    ("Any figure", "esc 2 f o"),
    ("Who buys", "esc esc n f enter"),
    ("Who stays", "esc n f enter"),
];

/// Maximum numbers of keys of the tasks, including typed letters.
const CHANGE_ONE_QUOTA: usize = 14;
const RAISE_A_PRICE: usize = 7;
const BUY_CAPACITY: usize = 3;
const ANSWER_ALL_COMPANIES: usize = 4;
const QUERY_CHART_EXPORT: usize = 42;
const POST: usize = 22;
const ORDER_A_STUDY: usize = 4;
const UNDO_TWICE_AND_REDO: usize = 3;
const COMPARE_TWO_RUNS: usize = 5;
const LEAVE_AND_GO_ON: usize = 2;

/// Presses keys one by one; each must change the picture, and none may be rejected.
fn do_it(console: &mut Console, keys: &str, most: usize) {
    let mut pressed = 0;
    for word in keys.split(' ') {
        let text = word.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\''));
        let single: Vec<String> = match text {
            Some(text) => text.chars().map(|letter| letter.to_string()).collect(),
            None => vec![word.to_owned()],
        };
        for key in single {
            let (buffer, cursor) = (console.draw(), console.cursor);
            console.key(&key);
            pressed += 1;
            if console.left.is_some() {
                continue;
            }
            let after = console.draw();
            let screen = console.screen();
            assert!(after != buffer || console.cursor != cursor, "{key} of {keys} has no effect:\n{screen}");
            let footer = screen.trim_end().lines().last().unwrap_or_default();
            assert!(!footer.contains(" ! "), "{key} of {keys} is rejected:\n{screen}");
        }
    }
    assert!(pressed <= most, "{keys}: {pressed} keys, {most} are enough");
}

/// Returns a current setting.
fn in_force(console: &Console, tool: &str, argument: &str) -> Value {
    let company = &console.app.run().expect("a run").company;
    company.settings[&tool.parse().expect("a tool")].get(argument).cloned().unwrap_or(Value::Null)
}

/// Starts a run with prices and quotas, and opens it in a new console.
fn shop(runs: &Path, size: (u16, u16)) -> Console {
    let mut console = Console::in_new_run(runs, size);
    console.press("8 enter enter '12' tab '25' tab '55' enter ctrl-s");
    console.press("down down enter enter '60k' tab '250k' tab '1.2M' enter ctrl-s q");
    drop(console);
    Console::in_latest_run(runs, size)
}

/// Opens a company that a policy has played.
fn company(policy: &str, seed: u64, until: u32, size: (u16, u16)) -> (TempDir, Console) {
    let runs = tempfile::tempdir().expect("a folder");
    led(policy, seed, until, runs.path());
    let console = Console::in_latest_run(runs.path(), size);
    (runs, console)
}

#[test]
fn the_tour_is_played_as_its_texts_say() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = Console::start(runs.path(), size);
        do_it(&mut console, "enter", 1);
        for (number, (title, keys)) in TOUR.iter().enumerate() {
            console.shows(&format!("Tour · {} of {} · {title}", number + 1, TOUR.len()));
            do_it(&mut console, keys, 40);
        }
        console.shows("tour completed");
        let company = &console.app.run().expect("a run").company;
        assert_eq!((company.seen.scenario.as_str(), company.seen.day), ("practice", 28));
        let signed = |week: usize| company.weeks[week].new_individual_subscribers;
        assert!(0 < signed(0) && signed(0) < signed(1), "the fix has an effect in the second week");
    }
}

#[test]
fn one_quota_is_changed() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = shop(runs.path(), size);
        do_it(&mut console, "8 down down enter down enter '300k' enter ctrl-s", CHANGE_ONE_QUOTA);
        let quotas = ["A", "B", "C"].map(|plan| in_force(&console, "set_usage_quotas", plan));
        assert_eq!(quotas, [json!(60_000), json!(300_000), json!(1_200_000)]);
    }
}

#[test]
fn a_price_is_raised() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = shop(runs.path(), size);
        do_it(&mut console, "8 enter enter '15' enter ctrl-s", RAISE_A_PRICE);
        assert_eq!(in_force(&console, "set_prices", "A"), json!(15));
    }
}

#[test]
fn capacity_is_bought_from_the_need() {
    for size in SIZES {
        let (_runs, mut console) = company("crisis.toml", 42, 210, size);
        let before = in_force(&console, "set_capacity_tier", "tier");
        console.press("down enter");
        let drafted = console.screen();
        assert!(drafted.contains("→ +$") && drafted.contains("from day 211"), "{drafted}");
        console.press("esc 1 up");
        do_it(&mut console, "down enter ctrl-s", BUY_CAPACITY);
        let after = in_force(&console, "set_capacity_tier", "tier");
        assert!(after.as_u64() > before.as_u64(), "{before} to {after}:\n{}", console.screen());
    }
}

#[test]
fn all_companies_are_answered() {
    for size in SIZES {
        let (_runs, mut console) = company("companies.toml", 3, 35, size);
        assert!(console.app.run().expect("a run").company.seen.waiting.len() > 1);
        do_it(&mut console, "6 a ctrl-s y", ANSWER_ALL_COMPANIES);
        assert_eq!(console.app.run().expect("a run").company.seen.waiting.len(), 0, "{}", console.screen());
    }
}

#[test]
fn a_query_is_written_drawn_and_exported() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = shop(runs.path(), size);
        console.week();
        console.press("esc");
        let keys = "9 'SELECT' _ 'day,amount' _ 'FROM' _ 'ledger' f5 esc . . e c";
        do_it(&mut console, keys, QUERY_CHART_EXPORT);
        let folder = console.app.run().expect("a run").company.folder.clone().expect("a folder");
        let text = std::fs::read_to_string(folder.join("query-0001.csv"))
            .unwrap_or_else(|problem| panic!("{problem}: {}", console.screen()));
        assert!(text.starts_with("day,amount\n"), "{text}");
    }
}

#[test]
fn a_post_is_published() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = shop(runs.path(), size);
        do_it(&mut console, "5 p 'Drafts,_at_once.' ctrl-s y", POST);
        console.shows("Drafts, at once.");
    }
}

#[test]
fn a_study_is_ordered() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = shop(runs.path(), size);
        do_it(&mut console, "7 down r y", ORDER_A_STUDY);
        assert_eq!(console.app.run().expect("a run").company.studies.len(), 1);
    }
}

#[test]
fn two_changes_are_undone_and_one_redone() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = shop(runs.path(), size);
        console.press("8 enter enter '15' enter ctrl-s enter enter '18' enter ctrl-s");
        do_it(&mut console, "u u U", UNDO_TWICE_AND_REDO);
        assert_eq!(in_force(&console, "set_prices", "A"), json!(15));
    }
}

#[test]
fn two_runs_are_compared() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        led("opening.toml", 3, 14, runs.path());
        led("companies.toml", 3, 14, runs.path());
        let mut console = Console::start(runs.path(), size);
        console.press("down down enter");
        do_it(&mut console, "space space v", COMPARE_TWO_RUNS);
        console.shows("Current figures");
    }
}

#[test]
fn one_leaves_and_goes_on() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = shop(runs.path(), size);
        console.week();
        console.press("esc");
        do_it(&mut console, "q", 1);
        drop(console);
        let run = list_runs(runs.path()).expect("a list").remove(0);
        assert_eq!(verify(&runs.path().join(&run.id)).expect("an intact run").day, 7);
        let mut console = Console::start(runs.path(), size);
        do_it(&mut console, "c", LEAVE_AND_GO_ON - 1);
        console.shows("day 7/500");
    }
}
