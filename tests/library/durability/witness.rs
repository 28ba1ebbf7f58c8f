//! What a witness outside the run's folder makes visible: rewritten lines, cut lines, copies that were put back.

use std::fs;
use std::path::{Path, PathBuf};

use novamind::session::{
    Access, Finding, FindingKind, Session, Trajectory, WitnessRecord, compare, line_of_code,
    lines_afterwards, read_witness,
};
use serde_json::Value;

use super::games::week;
use super::run::{copy, create, open, runs};
use crate::support::company::open_shop;
use crate::support::forging::forge;

const MACHINE: &str = "lab-3";

/// A run of some weeks of which a folder is told; both are closed.
struct Played {
    _place: tempfile::TempDir,
    witness: PathBuf,
    folder: PathBuf,
}

impl Played {
    fn weeks(weeks: u32) -> Played {
        let place = runs();
        let witness = place.path().join("share");
        fs::create_dir(&witness).expect("a folder");
        let mut session = create(&place.path().join("runs"), 21, 200);
        session.tell_witness(&witness, MACHINE);
        open_shop(&mut session);
        (0..weeks).for_each(|_| week(&mut session));
        session.save().expect("saved");
        let folder = session.folder().expect("a folder").to_owned();
        Played { _place: place, witness, folder }
    }

    /// Plays a folder on, telling as a machine.
    fn play_on(&self, folder: &Path, machine: &str, weeks: u32) {
        let mut session = open(folder);
        session.tell_witness(&self.witness, machine);
        (0..weeks).for_each(|_| week(&mut session));
        session.save().expect("saved");
    }

    fn told(&self) -> WitnessRecord {
        read_witness(&self.witness).expect("a witness")
    }

    fn findings(&self) -> Vec<Finding> {
        findings(&self.folder, &self.told())
    }
}

fn trajectory(folder: &Path) -> Trajectory {
    Trajectory::read(&folder.join("trajectory.jsonl")).expect("a whole chain")
}

fn findings(folder: &Path, told: &WitnessRecord) -> Vec<Finding> {
    let id = folder.file_name().expect("a name").to_string_lossy().into_owned();
    let trajectory = trajectory(folder);
    let after = lines_afterwards(folder, &trajectory).expect("it reads");
    compare(&trajectory, &after.lines, told.runs.get(&id).map_or(&[], Vec::as_slice))
}

fn kinds(findings: &[Finding]) -> Vec<FindingKind> {
    findings.iter().map(|finding| finding.kind).collect()
}

/// What stands beside the trajectory and remembers it: whoever cheats removes it.
fn remove_what_remembers(folder: &Path) {
    for name in ["world.db", "world.db-wal", "world.db-shm", "snapshot.bin"] {
        let _ = fs::remove_file(folder.join(name));
    }
}

#[test]
fn an_honest_session_is_told_line_by_line_and_gives_no_finding() {
    let run = Played::weeks(2);
    run.play_on(&run.folder, MACHINE, 1);
    let files: Vec<String> = fs::read_dir(&run.witness)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    let id = run.folder.file_name().expect("a name").to_string_lossy().into_owned();
    assert_eq!(files, [format!("{id}-{MACHINE}.jsonl")]);
    let told = run.told();
    let lines = trajectory(&run.folder).lines;
    let mut seqs: Vec<u64> = told.runs[&id].iter().map(|told| told.seq).collect();
    seqs.dedup();
    assert_eq!(seqs, (0..lines.len() as u64).collect::<Vec<_>>(), "every line, in order");
    for told in &told.runs[&id] {
        let line = &lines[told.seq as usize];
        assert_eq!((&told.hash, &told.at, told.machine.as_str()), (&line.hash, &line.at, MACHINE));
    }
    assert_eq!(run.findings(), []);
    assert!(!run.folder.join("witness-queue.jsonl").exists(), "nothing waits");
}

#[test]
fn a_code_on_paper_tells_which_line_a_trajectory_had_reached() {
    let run = Played::weeks(2);
    let mut session = open(&run.folder);
    week(&mut session);
    let (code, seq) = (session.code_words(), trajectory(&run.folder).lines.len() as u64 - 1);
    session.save().expect("saved");
    drop(session);
    run.play_on(&run.folder, MACHINE, 1);
    let line =
        |code: &str| line_of_code(&trajectory(&run.folder).lines, code).expect("a code").map(|line| line.seq);
    assert_eq!(line(&code), Some(seq));
    forge(&run.folder, |at, line| {
        if at == 0 {
            line["participant"] = "P99".into();
        }
    });
    assert_eq!(line(&code), None, "another history has other words");
}

#[test]
fn rewritten_lines_with_a_correct_chain_are_found() {
    let run = Played::weeks(3);
    let advance = |line: &Value| line["kind"] == "advance";
    let text = fs::read_to_string(run.folder.join("trajectory.jsonl")).expect("a trajectory");
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let second = lines.iter().enumerate().filter(|(_, line)| advance(line)).nth(1).expect("two weeks").0;
    forge(&run.folder, |at, line| {
        if at == second {
            line["rationale"] = "I knew it all along".into();
        }
    });
    remove_what_remembers(&run.folder);
    drop(open(&run.folder));
    let found = run.findings();
    assert_eq!(kinds(&found), [FindingKind::Changed], "{found:?}");
    assert_eq!(found[0].line, second as u64 + 1);
    assert_eq!(found[0].at, lines[second]["at"].as_str().expect("a moment"));
    // Who then plays on gives the witness two histories.
    run.play_on(&run.folder, MACHINE, 1);
    let found = run.findings();
    assert_eq!(kinds(&found), [FindingKind::TwoHistories], "{found:?}");
    assert_eq!(found[0].line, second as u64 + 1);
}

#[test]
fn weeks_that_were_cut_off_are_found_whatever_was_removed_with_them() {
    let run = Played::weeks(7);
    let path = run.folder.join("trajectory.jsonl");
    let whole = trajectory(&run.folder);
    let week =
        |week: usize| whole.lines.iter().filter(|line| line.closes_days()).nth(week).expect("a week").seq;
    let kept = week(1) as usize + 1;
    let text = fs::read_to_string(&path).expect("a trajectory");
    fs::write(&path, text.split_inclusive('\n').take(kept).collect::<String>()).expect("cut");
    remove_what_remembers(&run.folder);
    // The program itself cannot know.
    let session = open(&run.folder);
    assert_eq!((session.day(), session.remarks().len()), (14, 0));
    drop(session);
    let found = run.findings();
    assert_eq!(kinds(&found), [FindingKind::Cut], "{found:?}");
    assert_eq!(found[0].line, kept as u64 + 1);
    let missing = whole.lines.len() - kept;
    assert!(found[0].words.contains(&format!("{missing} lines are missing")), "{}", found[0].words);
    // Five other weeks in their place are no better.
    run.play_on(&run.folder, MACHINE, 5);
    let found = run.findings();
    assert!(kinds(&found).contains(&FindingKind::TwoHistories), "{found:?}");
    assert_eq!(found[0].line, kept as u64 + 1);
}

#[test]
fn a_copy_that_is_played_and_one_that_is_put_back_are_found() {
    let run = Played::weeks(2);
    let aside = runs();
    let kept = copy(&run.folder, aside.path());
    let parting = trajectory(&run.folder).lines.len() as u64 + 1;
    // Two weeks are tried, the folder is put back, and the weeks are played again, knowing how they go.
    run.play_on(&run.folder, MACHINE, 2);
    fs::remove_dir_all(&run.folder).expect("gone");
    copy(&kept, run.folder.parent().expect("runs"));
    assert_eq!(kinds(&run.findings()), [FindingKind::Cut]);
    run.play_on(&run.folder, MACHINE, 3);
    let found = run.findings();
    assert_eq!(kinds(&found), [FindingKind::TwoHistories], "{found:?}");
    assert_eq!(found[0].line, parting);
    // The copy is told of, too, when it is played on another machine.
    run.play_on(&kept, "at-home", 1);
    let found = findings(&kept, &run.told());
    for kind in [FindingKind::TwoHistories, FindingKind::OtherMachine, FindingKind::Cut] {
        assert!(kinds(&found).contains(&kind), "{kind:?}: {found:?}");
    }
}

#[test]
fn weeks_without_a_witness_another_machine_and_a_clock_that_went_back_are_named() {
    let run = Played::weeks(1);
    let mut session = open(&run.folder);
    week(&mut session);
    week(&mut session);
    session.save().expect("saved");
    drop(session);
    // Who is told later learns the last line, which vouches for those before it from then on.
    run.play_on(&run.folder, "lab-4", 1);
    let found = run.findings();
    assert_eq!(kinds(&found), [FindingKind::Unseen, FindingKind::OtherMachine], "{found:?}");
    assert!(found[0].words.contains("in which 1 week ended"), "{}", found[0].words);
    let untold = findings(&run.folder, &WitnessRecord::default());
    assert_eq!(kinds(&untold), [FindingKind::Unseen]);
    let last = trajectory(&run.folder).lines.len() - 1;
    forge(&run.folder, |at, line| {
        if at == last {
            line["at"] = "2001-01-01T00:00:00Z".into();
        }
    });
    let found = run.findings();
    assert!(found.iter().any(|one| one.kind == FindingKind::ClockBack && one.line == last as u64 + 1));
}

#[test]
fn a_witness_that_cannot_be_reached_is_told_later_and_nothing_is_lost_by_a_crash() {
    let run = Played::weeks(0);
    let id = run.folder.file_name().expect("a name").to_string_lossy().into_owned();
    let queue = run.folder.join("witness-queue.jsonl");
    let (there, away) = (run.witness.clone(), run.witness.with_file_name("away"));
    // A share that is not mounted, and a file where a folder should be.
    for in_the_way in [false, true] {
        fs::rename(&there, &away).expect("away");
        if in_the_way {
            fs::write(&there, "no folder").expect("written");
        }
        let mut session = open(&run.folder);
        session.tell_witness(&there, MACHINE);
        week(&mut session);
        session.save().expect("saved");
        drop(session);
        assert_eq!(there.exists(), in_the_way, "nothing is made in place of a share");
        let waiting = fs::read_to_string(&queue).expect("a queue");
        assert_eq!(waiting.lines().last().map(|line| line.contains(&id)), Some(true));
        if in_the_way {
            fs::remove_file(&there).expect("gone");
        }
        fs::rename(&away, &there).expect("back");
    }
    let lines = trajectory(&run.folder).lines.len() as u64;
    assert!(run.told().runs[&id].iter().all(|told| told.seq < lines - 2), "the last weeks wait");
    assert_ne!(run.findings(), []);
    // The next session tells all of it first.
    run.play_on(&run.folder, MACHINE, 0);
    assert!(!queue.exists());
    assert_eq!(run.findings(), []);
}

#[test]
fn the_problem_of_a_witness_can_be_asked_and_damaged_lines_are_listed() {
    let run = Played::weeks(0);
    let mut session = open(&run.folder);
    assert_eq!(session.witness_problem(), None);
    let nowhere = run.witness.join("not-there");
    session.tell_witness(&nowhere, MACHINE);
    // The thread has tried at least once when it ends.
    while session.witness_problem().is_none() {
        std::thread::yield_now();
    }
    assert!(session.witness_problem().expect("a problem").contains("not-there"));
    drop(session);
    let file =
        fs::read_dir(&run.witness).expect("a folder").next().expect("a file").expect("an entry").path();
    let mut bytes = fs::read(&file).expect("bytes");
    let good = bytes.split(|byte| *byte == b'\n').count() - 1;
    bytes.extend_from_slice(b"{\"run\":\"torn");
    fs::write(&file, bytes).expect("written");
    // What follows a torn line begins on a line of its own.
    run.play_on(&run.folder, MACHINE, 1);
    let told = run.told();
    assert_eq!(told.unreadable, [(file, good + 1)]);
    assert_eq!(run.findings(), []);
    let reader = Session::open(&run.folder, Access::Read, false).expect("it opens");
    assert_eq!(reader.witness_problem(), None);
}
