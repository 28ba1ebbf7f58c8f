//! Everyday tasks, key by key, in windows of two sizes. Every key has an effect, no key is rejected, and no task needs
//! more keys than its maximum.

use std::path::Path;

use novamind::record::folder::runs::list_runs;
use novamind::session::verify;
use serde_json::{Value, json};
use tempfile::TempDir;

use super::company::copy_played_run;
use super::harness::Console;

/// Window sizes of the tasks.
const SIZES: [(u16, u16); 2] = [(80, 24), (120, 40)];

/// Maximum numbers of keys of the tasks, including typed letters.
const CHANGE_ONE_QUOTA: usize = 14;
const RAISE_A_PRICE: usize = 7;
const BUY_CAPACITY: usize = 3;
const ANSWER_ALL_ENTERPRISES: usize = 4;
const QUERY_CHART_EXPORT: usize = 42;
const PUBLISH_A_POST: usize = 22;
const ORDER_A_STUDY: usize = 4;
const UNDO_TWICE_AND_REDO: usize = 3;
const COMPARE_TWO_RUNS: usize = 5;
const LEAVE_AND_RESUME: usize = 2;

/// Presses keys one by one. Each key must change the screen, and no key may be rejected.
fn press_within(console: &mut Console, keys: &str, most: usize) {
    let mut pressed = 0;
    for word in keys.split(' ') {
        let text = word.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\''));
        let single: Vec<String> = match text {
            Some(text) => text.chars().map(|letter| letter.to_string()).collect(),
            None => vec![word.to_owned()],
        };
        for key in single {
            let (buffer, cursor) = (console.draw(), console.cursor);
            console.press_key(&key);
            pressed += 1;
            if console.exit.is_some() {
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

/// Returns the current value of a setting.
fn current_setting(console: &Console, tool: &str, argument: &str) -> Value {
    let company = &console.app.run().expect("a run").company;
    company.settings[&tool.parse().expect("a tool")].get(argument).cloned().unwrap_or(Value::Null)
}

/// Starts a run with prices and quotas, and opens it in a new console.
fn console_with_open_company(runs: &Path, size: (u16, u16)) -> Console {
    let mut console = Console::in_new_run(runs, size);
    console.press("8 enter enter '12' tab '25' tab '55' enter ctrl-s");
    console.press("down down enter enter '60k' tab '250k' tab '1.2M' enter ctrl-s q");
    drop(console);
    Console::in_latest_run(runs, size)
}

/// Opens a company that a policy has played.
fn console_in_played_run(policy: &str, seed: u64, until: u32, size: (u16, u16)) -> (TempDir, Console) {
    let runs = tempfile::tempdir().expect("a folder");
    copy_played_run(policy, seed, until, runs.path());
    let console = Console::in_latest_run(runs.path(), size);
    (runs, console)
}

#[test]
fn changing_a_quota_takes_few_keys() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = console_with_open_company(runs.path(), size);
        press_within(&mut console, "8 down down enter down enter '300k' enter ctrl-s", CHANGE_ONE_QUOTA);
        let quotas = ["A", "B", "C"].map(|plan| current_setting(&console, "set_usage_quotas", plan));
        assert_eq!(quotas, [json!(60_000), json!(300_000), json!(1_200_000)]);
    }
}

#[test]
fn raising_a_price_takes_few_keys() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = console_with_open_company(runs.path(), size);
        press_within(&mut console, "8 enter enter '15' enter ctrl-s", RAISE_A_PRICE);
        assert_eq!(current_setting(&console, "set_prices", "A"), json!(15));
    }
}

#[test]
fn buying_capacity_takes_few_keys() {
    for size in SIZES {
        let (_runs, mut console) = console_in_played_run("crisis.toml", 42, 210, size);
        let before = current_setting(&console, "set_capacity_tier", "tier");
        console.press("down enter");
        let drafted = console.screen();
        assert!(drafted.contains("→ +$") && drafted.contains("from day 211"), "{drafted}");
        console.press("esc 1 up");
        press_within(&mut console, "down enter ctrl-s", BUY_CAPACITY);
        let after = current_setting(&console, "set_capacity_tier", "tier");
        assert!(after.as_u64() > before.as_u64(), "{before} to {after}:\n{}", console.screen());
    }
}

#[test]
fn answering_all_threads_takes_few_keys() {
    for size in SIZES {
        let (_runs, mut console) = console_in_played_run("companies.toml", 3, 35, size);
        assert!(console.app.run().expect("a run").company.observation.waiting.len() > 1);
        press_within(&mut console, "6 a ctrl-s y", ANSWER_ALL_ENTERPRISES);
        assert_eq!(
            console.app.run().expect("a run").company.observation.waiting.len(),
            0,
            "{}",
            console.screen()
        );
    }
}

#[test]
fn query_chart_and_export_take_few_keys() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = console_with_open_company(runs.path(), size);
        console.advance_week();
        console.press("esc");
        let keys = "9 enter 'SELECT' _ 'day,amount' _ 'FROM' _ 'ledger' f5 esc . . e c";
        press_within(&mut console, keys, QUERY_CHART_EXPORT);
        let folder = console.app.run().expect("a run").company.folder.clone().expect("a folder");
        let text = std::fs::read_to_string(folder.join("query-0001.csv"))
            .unwrap_or_else(|problem| panic!("{problem}: {}", console.screen()));
        assert!(text.starts_with("day,amount\n"), "{text}");
    }
}

#[test]
fn publishing_a_post_takes_few_keys() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = console_with_open_company(runs.path(), size);
        press_within(&mut console, "5 p 'Drafts,_at_once.' ctrl-s y", PUBLISH_A_POST);
        console.assert_shows("Drafts, at once.");
    }
}

#[test]
fn ordering_a_market_study_takes_few_keys() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = console_with_open_company(runs.path(), size);
        press_within(&mut console, "7 down r y", ORDER_A_STUDY);
        assert_eq!(console.app.run().expect("a run").company.running_studies.len(), 1);
    }
}

#[test]
fn undo_and_redo_take_few_keys() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = console_with_open_company(runs.path(), size);
        console.press("8 enter enter '15' enter ctrl-s enter enter '18' enter ctrl-s");
        press_within(&mut console, "u u U", UNDO_TWICE_AND_REDO);
        assert_eq!(current_setting(&console, "set_prices", "A"), json!(15));
    }
}

#[test]
fn comparing_two_runs_takes_few_keys() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        copy_played_run("opening.toml", 3, 14, runs.path());
        copy_played_run("companies.toml", 3, 14, runs.path());
        let mut console = Console::start(runs.path(), size);
        console.press("down down enter");
        press_within(&mut console, "space space v", COMPARE_TWO_RUNS);
        console.assert_shows("Current figures");
    }
}

#[test]
fn leaving_and_resuming_takes_few_keys() {
    for size in SIZES {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = console_with_open_company(runs.path(), size);
        console.advance_week();
        console.press("esc");
        press_within(&mut console, "q", 1);
        drop(console);
        let run = list_runs(runs.path()).expect("a list").remove(0);
        assert_eq!(verify(&runs.path().join(&run.id)).expect("an intact run").day, 7);
        let mut console = Console::start(runs.path(), size);
        press_within(&mut console, "c", LEAVE_AND_RESUME - 1);
        console.assert_shows("day 7/500");
    }
}
