//! What-if: the decisions of a week are changed in forms, simulated, compared and adopted.

use std::ops::ControlFlow;
use std::path::Path;

use novamind::insight::{BranchFigure, DecisionEdit, RecordAnalysis, WhatIf};
use novamind::record::mode::Mode;
use novamind::report::whatif::comparison_cell;
use serde_json::json;

use super::harness::Console;
use crate::support::company::{advance_week, advance_weeks, apply_opening_decisions, begin_run, call_tool};

/// Plays ten weeks with decisions in weeks 1, 4 and 6, and opens the what-if at week 6.
fn console_in_what_if(runs: &Path, mode: Mode, size: (u16, u16)) -> Console {
    let mut session = begin_run(runs, mode, 84);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, 3);
    call_tool(&mut session, "set_prices", json!({"A": 30, "B": 60}));
    advance_weeks(&mut session, 2);
    call_tool(&mut session, "set_daily_spend", json!({"development": 900}));
    call_tool(&mut session, "set_capacity_tier", json!({"tier": 2}));
    for _ in 0..5 {
        advance_week(&mut session);
    }
    drop(session);
    let mut console = Console::in_latest_run(runs, size);
    console.press("; b");
    console
}

/// Returns the comparison cell of the cash at the end, computed without the console.
fn cash_cell(console: &Console, week: u32, edits: &[&str]) -> String {
    let folder = console.app.run().expect("a run").company.folder.clone().expect("a folder");
    let mut what_if = WhatIf::open(&folder).expect("a what-if");
    let edits: Vec<DecisionEdit> = edits.iter().map(|edit| edit.parse().expect(edit)).collect();
    let found = what_if.compare(week, None, &[edits], &|_, _| ControlFlow::Continue(()));
    let comparison = found.expect("an answer").expect("it is not stopped");
    comparison_cell(&comparison, &comparison.branches[1], BranchFigure::Cash, comparison.until)
}

/// Returns the lines of the calls to a tool.
fn call_line_numbers(console: &Console, tool: &str) -> Vec<u64> {
    let folder = console.app.run().expect("a run").company.folder.clone().expect("a folder");
    let decided = WhatIf::open(&folder).expect("a what-if").decisions(1).expect("decisions");
    let calls =
        decided.iter().filter(|decision| decision.call().is_some_and(|call| call.tool.name() == tool));
    calls.map(|decision| decision.seq()).collect()
}

#[test]
fn each_treatment_equals_the_edit_of_plain_mode() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_what_if(runs.path(), Mode::Sandbox, (120, 40));
    // The last completed week has no decisions and offers earlier weeks.
    console.assert_shows("You made no decisions in week 10.");
    console.assert_shows("2 decisions: daily spend, capacity");
    console.press("down enter");
    console.assert_shows("What if, decisions of week 4");
    console.assert_shows("price A ");
    let line = *call_line_numbers(&console, "set_prices").last().expect("a price");
    let cases = [
        ("enter", format!("drop {line}"), "leave out"),
        ("enter '0.5' enter", format!("change {line} {{\"A\": 15, \"B\": 30}}"), "× 0.5"),
        ("enter down enter '45' enter ctrl-s", format!("change {line} {{\"A\": 30, \"B\": 45}}"), "replace"),
    ];
    for (keys, edit, label) in cases {
        console.press(keys);
        console.assert_shows(label);
        console.press("ctrl-s");
        console.assert_shows("What if, from week 4");
        let cell = cash_cell(&console, 4, &[&edit]);
        console.assert_shows(&cell);
        console.press("esc");
    }
    console.press("enter");
    console.assert_shows("Nothing is changed yet.");
    // A decision of another week is added, and the first changed week starts the simulation.
    console.press("enter right right s '2' enter");
    console.assert_shows("2 changes · the simulation starts with week 4");
    console.press("ctrl-s");
    let development = *call_line_numbers(&console, "set_daily_spend").last().expect("a budget");
    let scaled = format!("change {development} {{\"development\": 1800}}");
    let cell = cash_cell(&console, 4, &[&format!("drop {line}"), &scaled]);
    console.assert_shows(&cell);
    console.assert_hides("{");
    // The unchanged run makes no claim about weeks that were not played.
    console.assert_shows("0  your decisions unchanged; week");
}

#[test]
fn refused_change_states_its_reason_and_can_be_removed() {
    let runs = tempfile::tempdir().expect("a folder");
    for size in [(60, 16), (80, 24), (120, 40), (200, 60)] {
        let mut console = console_in_what_if(runs.path(), Mode::Sandbox, size);
        console.press("enter down e enter '99' enter ctrl-s");
        console.assert_shows("! the capacity tier must be 0 to 7");
        console.press("up ctrl-s");
        console.assert_shows("A change cannot be simulated.");
        console.assert_shows("! the capacity tier must be 0 to 7");
        console.press("x");
        console.assert_shows("Nothing is changed yet.");
        console.press("s");
        console.assert_shows("! capacity is not an amount.");
        console.press("esc ; q");
    }
}

#[test]
fn call_that_the_branch_rejects_is_marked_in_the_list() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_what_if(runs.path(), Mode::Sandbox, (120, 40));
    // The most expensive R&D project costs more than the company has.
    console.press("enter a");
    while !console.screen().contains("› R&D projects") {
        console.press("down");
    }
    console.press("enter enter '20' enter ctrl-s ctrl-s");
    console.assert_shows("R&D projects rejected: ");
    console.press("esc");
    console.assert_shows("! rejected in the simulation: ");
}

#[test]
fn adopted_alternative_opens_with_the_changed_decision() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_what_if(runs.path(), Mode::Sandbox, (120, 40));
    console.press("enter x ctrl-s A");
    console.assert_shows("now playing run");
    let spend = call_line_numbers(&console, "set_daily_spend").len();
    assert_eq!(spend, 1, "the later budget is left out");
}

#[test]
fn unfinished_baseline_run_offers_no_what_if() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = begin_run(runs.path(), Mode::Baseline, 500);
    advance_week(&mut session);
    drop(session);
    let mut console = Console::in_latest_run(runs.path(), (80, 24));
    console.press("; b");
    console.assert_shows("not available in an unfinished baseline run");
    console.press("a enter ctrl-s");
    console.assert_hides("add a decision to");
    console.assert_shows("not available in an unfinished baseline run");
}
