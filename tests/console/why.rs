//! Causes of a change: opened with `; w` from figures on screens and in the weekly report, and unavailable in some runs.

use std::path::Path;

use novamind::record::mode::Mode;

use super::harness::Console;
use crate::support::company::{advance_week, advance_weeks, apply_opening_decisions, begin_run, call_tool};

/// Opens a run of ten weeks with higher prices in the last week.
fn console_in_run(runs: &Path, mode: Mode, size: (u16, u16)) -> Console {
    let mut session = begin_run(runs, mode, 84);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, 9);
    call_tool(&mut session, "set_prices", serde_json::json!({"A": 30, "B": 60}));
    advance_week(&mut session);
    drop(session);
    Console::in_latest_run(runs, size)
}

/// Opens the causes of the selected figure, waits for the result, and closes the dialog.
fn check_causes(console: &mut Console, heading: &str) {
    console.press("; w");
    console.assert_shows(heading);
    console.assert_shows("residual");
    console.press("esc");
}

#[test]
fn causes_open_from_figures_on_screens() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_run(runs.path(), Mode::Sandbox, (120, 40));
    for (keys, heading) in [
        ("1", "overload, week 10: "),
        ("2", "cash change, week 10: "),
        ("down", "income, week 10: "),
        ("down", "payments, week 10: "),
        ("end", "development, week 10: "),
        ("right right", "development, week 9: "),
        ("3", "subscribers of S1, week 10: "),
        ("3 right right right right right", "leads of S1, week 10: "),
        ("right right right", "cancellations of S1, week 10: "),
        ("right", "weekly churn of S1, week 10: "),
        ("3 enter tab", "conversion of S1, week 10: "),
        ("tab tab tab", "leads of S1, week 10: "),
        ("left down", "new subscribers of S1, week 9: "),
    ] {
        console.press(keys);
        check_causes(&mut console, heading);
    }
    console.press("esc esc g m ; w");
    console.assert_shows("explains a weekly figure");
}

#[test]
fn causes_open_from_week_report_lines() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_run(runs.path(), Mode::Sandbox, (120, 40));
    console.press("w");
    console.assert_shows("; w why");
    check_causes(&mut console, "cash change, week 10: ");
    console.assert_shows("Action needed");
    console.press("down");
    let name = selected_line(&mut console);
    console.press("; w");
    console.assert_shows(&format!("{}, week 10: ", name.split(',').next().expect("a name")));
    // A cause that is not a decision opens the source rows. Closing the source rows returns to the report.
    console.press("end enter");
    console.assert_shows("SELECT");
    console.press("esc");
    console.assert_shows("Action needed");
    // The cause "price" opens the form of prices and closes the report.
    for _ in 0..20 {
        if ["new subscribers", "conversion"].contains(&selected_line(&mut console).as_str()) {
            break;
        }
        console.press("down");
    }
    console.press("; w home");
    for _ in 0..6 {
        if console.screen().contains("› price") {
            break;
        }
        console.press("down");
    }
    console.press("enter");
    console.assert_shows("set_prices");
    assert!(!console.screen().contains("Action needed"));
}

/// Returns the selected line of the report.
fn selected_line(console: &mut Console) -> String {
    let screen = console.screen();
    let marked =
        screen.lines().find_map(|line| line.split_once("› ").filter(|(_, rest)| rest.contains(" → ")));
    let (_, rest) = marked.unwrap_or_else(|| panic!("no line is marked:\n{screen}"));
    rest.split("  ").next().expect("a name").trim().to_owned()
}

#[test]
fn unfinished_baseline_shows_no_causes() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_run(runs.path(), Mode::Baseline, (120, 40));
    console.press("w");
    let report = console.screen();
    assert!(report.contains("Most unusual changes") && !report.contains("; w"), "{report}");
    for word in ["because", "due to", "caused", "cause", "may be", "led to", "thanks to"] {
        assert!(!report.contains(word), "{word}:\n{report}");
    }
    console.press("; w");
    console.assert_shows("not available in an unfinished baseline");
    assert!(!console.screen().contains("composition"));
}
