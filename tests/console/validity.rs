//! What each mode shows: nothing that depends on re-simulation, hidden state or outside help is shown in an unfinished
//! baseline run or study. Each row of [`ELEMENTS`] opens one element in every mode.
//!
//! To add an element, add a row: its keys, and what each mode shows.

use std::path::Path;

use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::session::read_afterwards;

use super::harness::Console;
use super::participant_sessions::StudyHome;
use crate::support::company::{advance_weeks, apply_opening_decisions, begin_run};
use crate::support::record::{inspections, read_trajectory, run_folder};

/// What a mode shows when an element is opened.
#[derive(Debug, Clone, Copy)]
enum Expected {
    /// The screen contains the text. In an unfinished run, no inspection of hidden state is recorded.
    Shown(&'static str),
    /// The screen contains the reason, and the element is not opened.
    Refused(&'static str),
    /// The screen contains the text, and the record contains an inspection that starts with the second text.
    Recorded(&'static str, &'static str),
}
use Expected::{Recorded, Refused, Shown};

/// An element of the console.
struct Element {
    name: &'static str,
    /// Keys that open the element from the Overview.
    keys: &'static str,
    /// A text that is shown only if the element is open, for refusals.
    content: &'static str,
    baseline: Expected,
    study: Expected,
    /// A hosted session of a study.
    hosted: Expected,
    sandbox: Expected,
    /// A finished baseline run, opened again.
    finished: Expected,
}

const NO_RESIMULATION: Expected = Refused("not available in an unfinished baseline");
const NOT_HOSTED: Expected = Refused("has no function here");

const ELEMENTS: [Element; 9] = [
    Element {
        name: "Why",
        keys: "2 ; w",
        content: "residual",
        baseline: NO_RESIMULATION,
        study: NO_RESIMULATION,
        hosted: NOT_HOSTED,
        sandbox: Shown("residual"),
        finished: Shown("residual"),
    },
    Element {
        name: "what-if",
        keys: "; b",
        content: "You made no decisions",
        baseline: NO_RESIMULATION,
        study: NO_RESIMULATION,
        hosted: NOT_HOSTED,
        sandbox: Shown("You made no decisions in week"),
        finished: Shown("What if, decisions of week"),
    },
    Element {
        name: "Fit curve",
        keys: "; v",
        content: "true values",
        baseline: Shown("estimates of day"),
        study: Shown("estimates of day"),
        hosted: Shown("estimates of day"),
        sandbox: Shown("estimates of day"),
        finished: Recorded("true values", "curve S1"),
    },
    Element {
        name: "X-ray",
        keys: "; x",
        content: "reputation",
        baseline: Refused("x-ray is available in debug runs and in runs that have ended"),
        study: Refused("x-ray is available in debug runs and in runs that have ended"),
        hosted: NOT_HOSTED,
        sandbox: Refused("x-ray is available in debug runs and in runs that have ended"),
        finished: Shown("X-ray"),
    },
    Element {
        name: "Action needed",
        keys: "1",
        content: "",
        baseline: Shown("Action needed"),
        study: Shown("Action needed"),
        hosted: Shown("Action needed"),
        sandbox: Shown("Action needed"),
        finished: Shown("Action needed"),
    },
    Element {
        name: "own command: query",
        keys: "f11",
        content: "own 4711",
        baseline: Refused("own commands are closed in an unfinished baseline run"),
        study: Refused("own commands are closed in a study"),
        hosted: NOT_HOSTED,
        sandbox: Shown("own 4711"),
        finished: Shown("own 4711"),
    },
    Element {
        name: "own command: program",
        keys: "3 f12",
        content: "rows: 2",
        baseline: Refused("own commands are closed in an unfinished baseline run"),
        study: Refused("own commands are closed in a study"),
        hosted: NOT_HOSTED,
        sandbox: Shown("rows: 2"),
        finished: Shown("rows: 2"),
    },
    Element {
        name: "own command: lines",
        keys: "f10",
        content: "Execute 1 line?",
        baseline: Refused("own commands are closed in an unfinished baseline run"),
        study: Refused("own commands are closed in a study"),
        hosted: NOT_HOSTED,
        sandbox: Shown("Execute 1 line?"),
        finished: Shown("Execute 1 line?"),
    },
    Element {
        name: "own command in the palette",
        keys: ": 'Mine:_query'",
        content: "runs SELECT",
        baseline: Refused("unavailable (own commands"),
        study: Refused("no match"),
        hosted: Refused("no match"),
        sandbox: Shown("runs SELECT"),
        finished: Shown("runs SELECT"),
    },
];

/// The modes of the table, in the order of the fields of [`Element`].
#[derive(Debug, Clone, Copy, PartialEq)]
enum RunMode {
    Baseline,
    Study,
    Hosted,
    Sandbox,
    Finished,
}

impl Element {
    fn expected(&self, mode: RunMode) -> Expected {
        match mode {
            RunMode::Baseline => self.baseline,
            RunMode::Study => self.study,
            RunMode::Hosted => self.hosted,
            RunMode::Sandbox => self.sandbox,
            RunMode::Finished => self.finished,
        }
    }
}

const OWN_COMMANDS: &str = r#"
[[commands]]
name = "Mine: query"
key = "f11"
sql = "SELECT 'own ' || (4700 + 11) AS mine"

[[commands]]
name = "Mine: program"
key = "f12"
program = ["/bin/sh", "-c", "echo rows: $(wc -l)"]

[[commands]]
name = "Mine: lines"
key = "f10"
lines = ["set_prices A=13"]
"#;

const WINDOW: (u16, u16) = (200, 60);

/// Writes the own commands into a folder and returns the configuration of the folder.
fn configuration_in(folder: &Path) -> Configuration {
    std::fs::write(folder.join("commands.toml"), OWN_COMMANDS).expect("written");
    Configuration { folder: Some(folder.to_owned()), ..Configuration::bundled() }
}

/// Returns a console in a run of three weeks, and the folder of the run.
fn console_in_run(folder: &Path, mode: RunMode) -> (Console, std::path::PathBuf) {
    let runs = folder.join("runs");
    let recorded = if mode == RunMode::Sandbox { Mode::Sandbox } else { Mode::Baseline };
    let mut session = begin_run(&runs, recorded, 84);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, 3);
    let id = session.manifest().id.clone();
    if mode == RunMode::Finished {
        session.abandon().expect("it ends");
    }
    drop(session);
    let mut console = Console::start_with(configuration_in(folder), &runs, WINDOW);
    console.open(&id).expect("the run opens");
    (console, run_folder(&runs))
}

/// Returns the inspections in the record of a run, including those after its end.
fn recorded_inspections(run: &Path) -> Vec<String> {
    let trajectory = read_trajectory(run);
    let mut found = inspections(&trajectory);
    found.extend(inspections(&read_afterwards(run, &trajectory).expect("it reads")));
    found
}

/// Opens an element and compares the screen and the record with the table. Closes the element.
fn check_element(console: &mut Console, run: &Path, element: &Element, mode: RunMode) {
    let before = recorded_inspections(run).len();
    console.press(element.keys);
    let screen = console.screen();
    let about = format!("{} in {mode:?}", element.name);
    match element.expected(mode) {
        Shown(text) | Recorded(text, _) => assert!(screen.contains(text), "{about}: no {text}\n{screen}"),
        Refused(reason) => {
            assert!(screen.contains(reason), "{about}: no {reason}\n{screen}");
            assert!(!screen.contains(element.content), "{about}: {}\n{screen}", element.content);
        }
    }
    console.wait_for_jobs();
    let new = recorded_inspections(run).split_off(before);
    match element.expected(mode) {
        Recorded(_, inspection) => {
            assert!(new.iter().any(|line| line.starts_with(inspection)), "{about}: {new:?}");
        }
        _ if mode == RunMode::Finished => {}
        _ => assert_eq!(new, [""; 0], "{about}"),
    }
    console.press("esc esc esc");
    // Leaves the SQL editor, in which digits are text.
    console.press("esc 1");
}

fn check_mode(mode: RunMode) {
    for element in &ELEMENTS {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut console, run) = console_in_run(folder.path(), mode);
        console.press("esc 1");
        check_element(&mut console, &run, element, mode);
    }
}

#[test]
fn unfinished_baseline_run_shows_only_what_agents_have() {
    check_mode(RunMode::Baseline);
}

#[test]
fn sandbox_run_shows_explanations_but_no_hidden_state() {
    check_mode(RunMode::Sandbox);
}

#[test]
fn finished_baseline_run_shows_everything_and_records_inspections() {
    check_mode(RunMode::Finished);
}

/// Plays the first week of P01 and compares every element with the table.
fn check_study(lab: &StudyHome, mut console: Console, keys: &str, mode: RunMode) {
    console.press(keys);
    console.advance_week();
    console.press("esc");
    let run = lab.participant_runs("P01").remove(0);
    for element in &ELEMENTS {
        check_element(&mut console, &run, element, mode);
    }
}

#[test]
fn study_shows_only_what_agents_have() {
    let (lab, folder) = (StudyHome::without_week_questions(), tempfile::tempdir().expect("a folder"));
    let console = lab.open_console_with(configuration_in(folder.path()), WINDOW);
    check_study(&lab, console, "'P01' enter end y enter 4 enter enter", RunMode::Study);
}

#[test]
fn hosted_session_shows_only_what_agents_have_and_starts_no_program() {
    let (lab, folder) = (StudyHome::without_week_questions(), tempfile::tempdir().expect("a folder"));
    let console = lab.open_hosted_console("P01", configuration_in(folder.path()), WINDOW);
    check_study(&lab, console, "end y enter 4 enter enter", RunMode::Hosted);
}
