//! Tests of power cuts: unsynced data is lost, confirmed lines are not (docs/formats/trajectory.md#durability).

use std::path::Path;

use serde_json::json;

use crate::archive::{Export, Imported, import_run};
use crate::create::{NewRun, Storage};
use crate::play::Session;
use crate::play::open::Access;
use crate::snapshot::sealing::SealKey;
use novamind_record::files::probe;
use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::{Ended, Via};
use novamind_record::trajectory::{PageCache, Trajectory};
use novamind_tools::Refusal;

fn new_run(runs: &Path) -> NewRun {
    NewRun { seed: Some(8), storage: Storage::Runs(runs.to_owned()), ..NewRun::default() }
}

/// Creates a run whose trajectory is on a disk that can fail.
fn session(new: NewRun) -> (Session, PageCache) {
    let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
    let path = session.folder().expect("a folder").join("trajectory.jsonl");
    let cache = PageCache::holding(std::fs::read(path).expect("bytes"));
    session.write_to(Box::new(cache.clone()));
    (session, cache)
}

fn roll(state: &mut u64, sides: u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) % sides
}

fn act(session: &mut Session, chance: &mut u64) -> Result<(), Refusal> {
    match roll(chance, 6) {
        0 => drop(session.query("SELECT COUNT(*) FROM ledger")),
        1 => session.activity().note_view("cash", "overview", 900),
        2 => session.set_memo(&format!("note {}", roll(chance, 100)))?,
        _ => {
            let prices = json!({ "A": 5 + roll(chance, 20), "B": 30 });
            session.call("set_prices", &prices, Via::Form)?;
        }
    }
    Ok(())
}

fn week(session: &mut Session) {
    let forecasts = session.company().naive_forecasts();
    session.advance("on", &forecasts, Via::Form, &mut |_| {}).expect("a week");
}

/// Copies the run folder as it can be after a power cut: unsynced data of any file can be partly on the disk.
fn after_the_cut(session: &Session, to: &Path, cache: &PageCache, chance: &mut u64) {
    let folder = session.folder().expect("a folder");
    // SQLite handles power cuts of the database itself; its files are copied while nothing writes them.
    session.database().wait().expect("it is written");
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let mut bytes = std::fs::read(entry.path()).expect("bytes");
        match name.as_ref() {
            "trajectory.jsonl" => {
                bytes = cache.after_a_power_cut();
                let unsynced = cache.after_a_kill().split_off(bytes.len());
                let reached = roll(chance, unsynced.len() as u64 + 1) as usize;
                bytes.extend_from_slice(&unsynced[..reached]);
            }
            "world.db-wal" if roll(chance, 2) == 0 => continue,
            "world.db-shm" => continue,
            "snapshot.bin" => bytes.truncate(roll(chance, 2 * bytes.len() as u64) as usize),
            _ => {}
        }
        std::fs::write(to.join(name.as_ref()), bytes).expect("written");
    }
}

#[test]
fn nothing_confirmed_is_lost_when_the_power_fails() {
    let runs = tempfile::tempdir().expect("a folder");
    let places = tempfile::tempdir().expect("a folder");
    let (mut session, cache) = session(NewRun { days: Some(200), ..new_run(runs.path()) });
    let mut chance = 5;
    for number in 0..30 {
        for _ in 0..roll(&mut chance, 5) {
            act(&mut session, &mut chance).expect("the disk takes it");
        }
        if number % 3 == 2 {
            week(&mut session);
        }
        let place = places.path().join(number.to_string());
        after_the_cut(&session, &place, &cache, &mut chance);
        let resumed = Session::open(&place, Access::Write, true).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(resumed.journal(), session.journal(), "cut {number}");
        assert_eq!(resumed.state_hash(), session.state_hash(), "cut {number}");
        assert_eq!(resumed.memo().expect("notes"), session.memo().expect("notes"), "cut {number}");
    }
}

#[test]
fn headless_runs_keep_every_complete_week() {
    let runs = tempfile::tempdir().expect("a folder");
    let places = tempfile::tempdir().expect("a folder");
    let new = NewRun { days: Some(200), sync_calls: false, ..new_run(runs.path()) };
    let (mut session, cache) = session(new);
    let mut chance = 6;
    for number in 0..12 {
        week(&mut session);
        let closed = session.state_hash();
        for _ in 0..roll(&mut chance, 4) {
            let prices = json!({ "A": 5 + roll(&mut chance, 20) });
            session.call("set_prices", &prices, Via::Policy).expect("prices");
        }
        if roll(&mut chance, 2) == 0 {
            // A query of a policy returns the effects of its calls; the database is never ahead of the disk.
            session.query("SELECT COUNT(*) FROM config_history").expect("rows");
        }
        let place = places.path().join(number.to_string());
        after_the_cut(&session, &place, &cache, &mut chance);
        let resumed = Session::open(&place, Access::Write, true).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(resumed.weeks(), session.weeks(), "cut {number}");
        if resumed.journal().len() == session.journal().len() {
            assert_eq!(resumed.state_hash(), session.state_hash(), "cut {number}");
        } else if !matches!(
            resumed.journal().last(),
            Some(crate::figures::journal::JournalEntry::Call { .. })
        ) {
            assert_eq!(resumed.state_hash(), closed, "cut {number}");
        }
    }
}

#[test]
fn nothing_confirmed_is_lost_when_syncs_fail_before_the_power_does() {
    let runs = tempfile::tempdir().expect("a folder");
    let places = tempfile::tempdir().expect("a folder");
    let (mut session, cache) = session(NewRun { days: Some(200), ..new_run(runs.path()) });
    let mut chance = 7;
    let (mut refused, mut unsaved_weeks) = (0, 0);
    for number in 0..30 {
        for _ in 0..roll(&mut chance, 5) {
            cache.fail_syncs(roll(&mut chance, 4) as u32);
            refused += u32::from(act(&mut session, &mut chance).is_err());
        }
        cache.fail_syncs(0);
        if number % 3 == 2 {
            let failing = roll(&mut chance, 4) as u32;
            let forecasts = session.company().naive_forecasts();
            let week = session.advance("on", &forecasts, Via::Form, &mut |_| cache.fail_syncs(failing));
            let remark = week.expect("a week").remark;
            let is_unsaved = remark.is_some_and(|remark| remark.contains("simulated again"));
            assert_eq!(is_unsaved, failing >= 2, "{failing} syncs fail");
            unsaved_weeks += u32::from(is_unsaved);
        }
        let place = places.path().join(number.to_string());
        after_the_cut(&session, &place, &cache, &mut chance);
        let resumed = Session::open(&place, Access::Write, true).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(resumed.journal(), session.journal(), "cut {number}");
        assert_eq!(resumed.state_hash(), session.state_hash(), "cut {number}");
    }
    assert!(refused > 0 && unsaved_weeks > 0, "{refused} {unsaved_weeks}");
}

#[test]
fn a_last_week_whose_lines_miss_the_disk_ends_the_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let places = tempfile::tempdir().expect("a folder");
    let (mut session, cache) = session(NewRun { days: Some(28), ..new_run(runs.path()) });
    (0..3).for_each(|_| week(&mut session));
    let forecasts = session.company().naive_forecasts();
    let last = session.advance("on", &forecasts, Via::Form, &mut |_| cache.set_full(true)).expect("a week");
    assert_eq!((last.ended, session.ended()), (Some(Ended::Horizon), Some(Ended::Horizon)));
    assert!(last.remark.expect("the disk is full").contains("simulated again"));
    let refused = session.advance("on", &forecasts, Via::Form, &mut |_| {}).expect_err("it is over");
    assert_eq!((refused.code, session.weeks().len(), session.day()), ("run_over", 4, 28));
    // No line can follow an end that is not on the disk.
    let afterwards = session.folder().expect("a folder").join("afterwards.jsonl");
    assert_eq!(session.set_memo("after the end").expect_err("no room").code, "not_saved");
    assert!(!afterwards.exists());
    let mut chance = 3;
    let (before, after) = (places.path().join("before"), places.path().join("after"));
    after_the_cut(&session, &before, &cache, &mut chance);
    cache.set_full(false);
    session.set_memo("after the end").expect("space is available again");
    assert!(afterwards.exists() && probe::has_synced(&afterwards));
    after_the_cut(&session, &after, &cache, &mut chance);
    let trajectory = Trajectory::read(&after.join("trajectory.jsonl")).expect("it reads");
    assert!(trajectory.end().is_some());
    for place in [before, after] {
        let resumed = Session::open(&place, Access::Write, true).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((resumed.ended(), resumed.score()), (session.ended(), session.score()));
        assert_eq!(resumed.weeks(), session.weeks());
        assert_eq!(resumed.state_hash(), session.state_hash());
    }
}

#[test]
fn a_run_whose_end_the_disk_refuses_is_not_given_up() {
    let runs = tempfile::tempdir().expect("a folder");
    let (mut session, cache) = session(NewRun { days: Some(28), ..new_run(runs.path()) });
    cache.fail_syncs(2);
    assert_eq!(session.end().expect_err("the disk fails").code, "not_saved");
    assert_eq!(session.ended(), None);
    week(&mut session);
    session.end().expect("given up");
    assert_eq!((session.ended(), session.score()), (Some(Ended::Abandoned), None));
    assert!(Trajectory::parse(&cache.after_a_power_cut()).expect("it reads").end().is_some());
}

#[test]
fn names_of_runs_and_archives_are_on_the_disk() {
    let place = tempfile::tempdir().expect("a folder");
    let runs = place.path().join("new/runs");
    probe::reset(true);
    assert!(Session::create(new_run(&runs), &Configuration::shipped()).is_err());
    assert!(!place.path().join("new").exists(), "no folder remains");
    probe::reset(false);
    let mut session = Session::create(new_run(&runs), &Configuration::shipped()).expect("a run");
    let folder = session.folder().expect("a folder").to_owned();
    for path in [runs.clone(), folder.clone(), folder.join("run.toml"), folder.join("trajectory.jsonl")] {
        assert!(probe::has_synced(&path), "{}", path.display());
    }
    session.set_memo("kept").expect("kept");
    assert!(probe::has_synced(&folder.join("memo.draft")) && probe::has_synced(&folder.join("memo.md")));
    week(&mut session);
    session.save().expect("saved");
    drop(session);
    let archive = place.path().join("run.tar.gz");
    let export = Export::prepare(&folder, place.path(), &SealKey::default()).expect("a run");
    probe::reset(true);
    assert!(export.write(&archive, false, None).is_err());
    probe::reset(false);
    export.write(&archive, true, None).expect("an archive");
    assert!(probe::has_synced(&archive));
    let other = place.path().join("other");
    let Imported::New(imported) = import_run(&other, &archive, None).expect("imported").2 else {
        panic!("it is new")
    };
    assert!(probe::has_synced(&other) && probe::has_synced(&imported));
}
