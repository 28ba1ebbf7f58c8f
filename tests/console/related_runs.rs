//! Related runs in the Journal: the displayed tree, opening a branch, and runs without a tree.

use std::fmt::Write;
use std::path::Path;

use novamind::record::mode::Mode;
use novamind::session::{SeekTarget, Session};
use serde_json::json;

use super::harness::Console;
use super::picture_checks::{SIZES, needlessly_truncated_lines};
use super::replay::{console_in_replay, played_run};
use crate::support::company::{advance_weeks, call_tool};

/// Creates a run of four weeks, a branch from week 3 with different decisions, and a branch of the branch. Returns the
/// IDs of the three runs.
fn create_related_runs(runs: &Path) -> [String; 3] {
    let id = |session: &Session| session.manifest().id.clone();
    let root = played_run(runs, Mode::Sandbox, 4);
    let mut cheaper = root.branch(3, Mode::Sandbox).expect("a branch");
    call_tool(&mut cheaper, "set_prices", json!({"A": 9}));
    advance_weeks(&mut cheaper, 2);
    let later = cheaper.branch(4, Mode::Sandbox).expect("a branch");
    [id(&root), id(&cheaper), id(&later)]
}

fn console_in_run(runs: &Path, id: &str, size: (u16, u16)) -> Console {
    let mut console = Console::start(runs, size);
    console.open(id).expect("it opens");
    console
}

/// Returns the screen with fixed names instead of the run IDs.
fn screen_without_ids(console: &mut Console, ids: &[String; 3]) -> String {
    let names = ["run-root", "run-left", "run-late"];
    ids.iter().zip(names).fold(console.screen(), |text, (id, name)| text.replace(id, name))
}

#[test]
fn run_tree_matches_snapshots() {
    let runs = tempfile::tempdir().expect("a folder");
    let ids = create_related_runs(runs.path());
    let mut console = console_in_run(runs.path(), &ids[1], SIZES[2]);
    console.press("0 shift-tab");
    let (mut text, mut complaints) = (String::new(), Vec::new());
    for size in SIZES {
        console.size = size;
        let letters = screen_without_ids(&mut console, &ids);
        complaints
            .extend(needlessly_truncated_lines(&letters).into_iter().map(|line| format!("{size:?}: {line}")));
        writeln!(text, "{}×{}\n{letters}", size.0, size.1).expect("text");
    }
    insta::assert_snapshot!("journal-branches", text);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn run_tree_opens_by_key_in_small_windows() {
    let runs = tempfile::tempdir().expect("a folder");
    let ids = create_related_runs(runs.path());
    for size in SIZES {
        let mut console = console_in_run(runs.path(), &ids[1], size);
        console.press("0");
        console.assert_shows("t tree of 3 runs");
        console.press("t");
        let screen = console.screen();
        assert!(ids.iter().all(|id| screen.contains(id)), "{size:?}:\n{screen}");
    }
}

#[test]
fn enter_opens_a_branch_and_confirms_unsaved_text() {
    let runs = tempfile::tempdir().expect("a folder");
    let ids = create_related_runs(runs.path());
    let mut console = console_in_run(runs.path(), &ids[1], (120, 40));
    console.press("0 shift-tab enter");
    console.assert_shows(&format!("run {} is already open", ids[1]));
    // The root run is listed first. There are no drafts, so no confirmation is required.
    console.press("up enter");
    let here = |console: &Console| console.app.run().map(|run| run.company.observation.run.clone());
    assert_eq!(here(&console).as_deref(), Some(ids[0].as_str()));
    console.press("0 e 'mine' esc shift-tab shift-tab down down enter");
    console.assert_shows("is saved with the run");
    console.press("esc");
    assert_eq!(here(&console).as_deref(), Some(ids[0].as_str()));
    console.press("enter y");
    assert_eq!(here(&console).as_deref(), Some(ids[2].as_str()));
    // After the run is opened again, its notes contain the draft.
    console.press("0 shift-tab up up enter");
    assert_eq!(here(&console).as_deref(), Some(ids[0].as_str()));
    console.assert_shows("mine");
}

#[test]
fn replay_shows_the_run_tree_and_opens_a_branch() {
    let runs = tempfile::tempdir().expect("a folder");
    let ids = create_related_runs(runs.path());
    let mut console = console_in_replay(runs.path(), (120, 40), SeekTarget::Week(1));
    console.press("0");
    for id in &ids {
        console.assert_shows(id);
    }
    console.press("shift-tab down down down up enter");
    assert!(console.app.run().is_some_and(|run| run.playback.is_none()));
}

#[test]
fn run_without_branches_has_no_tree() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(played_run(runs.path(), Mode::Sandbox, 1));
    drop(played_run(runs.path(), Mode::Sandbox, 2));
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.press("0");
    let screen = console.screen();
    assert!(!screen.contains("Branches") && !screen.contains("t tree"), "{screen}");
}

#[test]
fn copied_run_folder_appears_once_in_the_tree() {
    let runs = tempfile::tempdir().expect("a folder");
    let ids = create_related_runs(runs.path());
    let copy = runs.path().join("copied");
    std::fs::create_dir(&copy).expect("a folder");
    for entry in std::fs::read_dir(runs.path().join(&ids[1])).expect("files").flatten() {
        if entry.path().is_file() {
            std::fs::copy(entry.path(), copy.join(entry.file_name())).expect("a copy");
        }
    }
    let mut console = console_in_run(runs.path(), &ids[0], (120, 40));
    console.press("0 t");
    let screen = console.screen();
    assert!(!screen.contains("copied"), "{screen}");
    let listed = novamind::record::folder::runs::list_runs(runs.path()).expect("a list");
    let copies: Vec<_> =
        listed.iter().filter_map(|run| Some((run.id.as_str(), run.copy_of.as_deref()?))).collect();
    assert_eq!(copies, [("copied", ids[1].as_str())]);
}
