//! The X-ray screen: its pictures, the words of plain mode, breakpoints, and where it shows nothing.

use std::fmt::Write;
use std::path::Path;

use novamind::session::{
    Access, Activity, Configuration, Goal, Mode, NewRun, Record, Session, Storage, Trajectory,
    lines_afterwards, verify,
};
use novamind::world::identifiers::Group;

use super::harness::Console;
use super::looks::cut_with_room;
use super::replay::replayed;
use crate::support::company::{open_shop, weeks};

/// Sizes of windows: the smallest that is drawn, the smallest that is promised, a usual one, a large one.
const SIZES: [(u16, u16); 4] = [(60, 16), (80, 24), (120, 40), (200, 60)];

fn run(runs: &Path, mode: Mode, count: usize) -> Session {
    let new = NewRun {
        seed: Some(7),
        days: Some(84),
        mode,
        participant: (mode == Mode::Baseline).then(|| "P01".to_owned()),
        storage: Storage::Runs(runs.to_owned()),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
    open_shop(&mut session);
    weeks(&mut session, count);
    session
}

/// A console in a debug run of some weeks, on the X-ray screen.
fn looking(runs: &Path, count: usize, size: (u16, u16)) -> Console {
    drop(run(runs, Mode::Debug, count));
    let mut console = Console::in_latest_run(runs, size);
    console.press("g x");
    console
}

/// What was looked at, in the order of the lines.
fn looks(lines: &Trajectory) -> Vec<String> {
    let look = |record: &Record| match record {
        Record::Activity(Activity::Xray(look)) => {
            Some(format!("{} {} {}", look.what, look.which, look.shown_day))
        }
        _ => None,
    };
    lines.lines.iter().filter_map(|line| look(&line.record)).collect()
}

fn folder_of(runs: &Path) -> std::path::PathBuf {
    let folders = std::fs::read_dir(runs).expect("a folder").flatten().map(|entry| entry.path());
    folders.filter(|path| path.is_dir()).max().expect("a run")
}

fn recorded(folder: &Path) -> Trajectory {
    Trajectory::read(&folder.join("trajectory.jsonl")).expect("lines")
}

fn picture(console: &mut Console, complaints: &mut Vec<String>) -> String {
    let mut text = String::new();
    for size in SIZES {
        console.size = size;
        let letters = console.screen();
        complaints.extend(cut_with_room(&letters).into_iter().map(|line| format!("{size:?}: {line}")));
        writeln!(text, "{}×{}\n{letters}", size.0, size.1).expect("text");
    }
    console.size = SIZES[2];
    text
}

#[test]
fn every_view_in_windows_of_four_sizes() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = looking(runs.path(), 10, SIZES[2]);
    let mut complaints = Vec::new();
    let views = [
        ("leads", "enter = down down"),
        ("quality", "esc down"),
        ("satisfaction", "down"),
        ("reputation", "down"),
        ("spill-over", "down"),
        ("rivals", "down"),
        ("drift", "down"),
        ("streams", "down e 'service' enter esc"),
        ("customer", "down enter '3' enter enter '1200' enter"),
        ("breakpoints", "esc down enter enter 'churn(S1)>1%' enter e 'event' _ 'rival' enter"),
    ];
    for (view, keys) in views {
        console.press(keys);
        let picture = picture(&mut console, &mut complaints);
        insta::assert_snapshot!(format!("xray-{view}"), picture);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn the_screen_says_what_plain_mode_says_and_each_look_is_a_line() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = looking(runs.path(), 4, (200, 60));
    // The group is typed, the day is walked to.
    console.press("e 's2' enter left left ,");
    console.shows("day 19 of 28");
    let screen = console.screen();
    drop(console);
    let folder = folder_of(runs.path());
    let told = looks(&recorded(&folder));
    assert_eq!(told, ["leads S1 28", "leads S2 28", "leads S2 27", "leads S2 26", "leads S2 19"]);
    assert_eq!(verify(&folder).expect("it verifies").day, 28);
    let mut session = Session::open(&folder, Access::Write, false).expect("it opens");
    let group = Group::parse("S2").expect("a group");
    let days = session.lead_equations(group, Some(19)).expect("a look");
    let own = days.last().expect("a day");
    for part in ["leads of S2 on day 19".to_owned(), format!("λ {:.2}, came {}", own.expected(), own.came)] {
        assert!(screen.contains(&part), "{part} is missing in\n{screen}");
    }
}

#[test]
fn looking_changes_no_hash() {
    let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let hashes = [true, false].map(|looks| {
        let runs = folders[usize::from(looks)].path();
        drop(run(runs, Mode::Debug, 3));
        let mut console = Console::in_latest_run(runs, (120, 40));
        if looks {
            console.press("g x left left = down tab down , . enter e 's2' enter 1");
        }
        console.week();
        drop(console);
        Session::open(&folder_of(runs), Access::Read, false).expect("it opens").state_hash()
    });
    assert_eq!(hashes[0], hashes[1]);
}

#[test]
fn a_held_factor_shows_the_expected_leads_beside() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = looking(runs.path(), 3, (120, 40));
    console.press("enter =");
    console.shows("with R 1: λ");
    console.press("down =");
    console.shows("with R 1, D 1: λ");
    console.press("= up =");
    assert!(!console.screen().contains("instead of"), "{}", console.screen());
}

#[test]
fn a_debug_run_runs_to_a_breakpoint_that_is_set_on_the_screen() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(run(runs.path(), Mode::Debug, 2));
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.press("; k");
    console.shows("no breakpoint is set");
    console.press("e 'leads(S1)>1' enter e 'nonsense' enter");
    console.shows("nonsense");
    console.press("esc e 'cash<0' enter");
    console.shows("2 cash < 0");
    console.press("b");
    console.shows("cash < 0 is false on day 14");
    console.press("r 'x' enter");
    console.shows("type a number of days");
    console.press("esc tab tab down delete");
    assert!(!console.screen().contains("cash < 0"), "{}", console.screen());
    console.press("r '28' enter");
    console.shows("day 42");
    console.shows("the breakpoint did not become true");
    console.press("e 'leads(S2)>=1' enter delete e 'cash<850000' enter r '20' enter");
    console.shows("stopped on day");
    drop(console);
    let told = looks(&recorded(&folder_of(runs.path())));
    assert!(told.contains(&"breakpoint leads(S1) > 1 42".to_owned()), "{told:?}");
}

#[test]
fn an_unfinished_run_of_another_mode_shows_one_sentence_and_no_tab() {
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let runs = tempfile::tempdir().expect("a folder");
        drop(run(runs.path(), mode, 1));
        let mut console = Console::in_latest_run(runs.path(), (120, 40));
        assert!(!console.screen().contains("X-ray"), "{}", console.screen());
        for keys in ["g x", "; k", "e r b = left , delete enter tab down z"] {
            console.press(keys);
            let screen = console.screen();
            assert!(screen.contains("The x-ray works in debug runs and in runs that are over."), "{screen}");
            assert!(!screen.contains("g x X-ray") && !screen.contains("day 7 of"), "{screen}");
        }
        drop(console);
        assert_eq!(looks(&recorded(&folder_of(runs.path()))), Vec::<String>::new());
    }
}

#[test]
fn a_run_that_is_over_is_looked_into_in_its_replay_and_each_look_is_recorded() {
    for mode in [Mode::Baseline, Mode::Sandbox] {
        let runs = tempfile::tempdir().expect("a folder");
        let mut session = run(runs.path(), mode, 4);
        session.end().expect("it ends");
        drop(session);
        let mut console = replayed(runs.path(), (200, 60), Goal::Week(2));
        console.press("g x");
        console.shows("leads of S1 on day 14");
        console.press("right");
        console.shows("day 14 of 14");
        // Nothing is run in a replay.
        console.press("; k r '7' enter");
        console.shows("this is a replay");
        // Whoever leaves the replay can open the run: it is held no longer than that.
        console.press("esc Q");
        let folder = folder_of(runs.path());
        let id = folder.file_name().expect("a name").to_string_lossy().into_owned();
        console.open(&id).expect("it opens");
        drop(console);
        let after = lines_afterwards(&folder, &recorded(&folder)).expect("lines");
        assert_eq!(looks(&after), ["leads S1 14"]);
    }
}

#[test]
fn a_run_that_is_only_read_keeps_the_line_of_a_look() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = run(runs.path(), Mode::Sandbox, 2);
    session.end().expect("it ends");
    drop(session);
    let mut console = Console::start(runs.path(), (120, 40));
    console.look_at("latest").expect("it opens");
    console.press("esc g x");
    console.shows("leads of S1 on day 14");
    drop(console);
    let folder = folder_of(runs.path());
    let after = lines_afterwards(&folder, &recorded(&folder)).expect("lines");
    assert_eq!(looks(&after), ["leads S1 14"]);
}

#[test]
fn a_debug_run_that_somebody_else_plays_is_not_looked_into_from_its_replay() {
    let runs = tempfile::tempdir().expect("a folder");
    let held = run(runs.path(), Mode::Debug, 2);
    let mut console = replayed(runs.path(), (120, 40), Goal::Week(1));
    console.press("g x");
    assert!(!console.screen().contains("leads of S1 on day"), "{}", console.screen());
    drop(held);
}

#[test]
fn the_replay_of_an_unfinished_run_of_another_mode_shows_nothing() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(run(runs.path(), Mode::Sandbox, 2));
    let mut console = replayed(runs.path(), (120, 40), Goal::Week(1));
    console.press("g x");
    console.shows("The x-ray works in debug runs and in runs that are over.");
}
