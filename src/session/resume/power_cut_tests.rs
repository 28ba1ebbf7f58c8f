//! Tests of power cuts: unsynced data is lost, but confirmed lines survive (docs/formats/trajectory.md#durability).

use std::path::Path;

use serde_json::json;

use crate::archive::{Export, ImportOutcome, import_run};
use crate::create::{NewRun, Storage};
use crate::play::Session;
use crate::play::open::Access;
use crate::snapshot::sealing::SealKey;
use novamind_record::files::sync_probe;
use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::{RunEndReason, Via};
use novamind_record::trajectory::{PageCache, Trajectory};
use novamind_tools::Rejection;

fn new_run(runs: &Path) -> NewRun {
    NewRun { seed: Some(8), storage: Storage::Runs(runs.to_owned()), ..NewRun::default() }
}

/// Creates a run whose trajectory is on a disk that can fail.
fn new_session(new: NewRun) -> (Session, PageCache) {
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    let path = session.folder().expect("a folder").join("trajectory.jsonl");
    let cache = PageCache::with_synced_bytes(std::fs::read(path).expect("bytes"));
    session.set_medium(Box::new(cache.clone()));
    (session, cache)
}

fn random_below(state: &mut u64, sides: u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) % sides
}

fn act_randomly(session: &mut Session, chance: &mut u64) -> Result<(), Rejection> {
    match random_below(chance, 6) {
        0 => drop(session.query("SELECT COUNT(*) FROM ledger")),
        1 => session.activity().record_view("cash", "overview", 900),
        2 => session.set_notes(&format!("note {}", random_below(chance, 100)))?,
        _ => {
            let prices = json!({ "A": 5 + random_below(chance, 20), "B": 30 });
            session.call("set_prices", &prices, Via::Form)?;
        }
    }
    Ok(())
}

fn advance_week(session: &mut Session) {
    let forecasts = session.company().naive_forecasts();
    session.advance("on", &forecasts, Via::Form, &mut |_| {}).expect("a week");
}

/// Copies the run folder in a possible state after a power cut: any part of the unsynced data can be on the disk.
fn copy_after_power_cut(session: &Session, to: &Path, cache: &PageCache, chance: &mut u64) {
    let folder = session.folder().expect("a folder");
    // SQLite protects the database against power cuts. Copy its files while no thread writes them.
    session.database().wait_until_written().expect("it is written");
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let mut bytes = std::fs::read(entry.path()).expect("bytes");
        match name.as_ref() {
            "trajectory.jsonl" => {
                bytes = cache.bytes_after_power_cut();
                let unsynced = cache.bytes_after_kill().split_off(bytes.len());
                let reached = random_below(chance, unsynced.len() as u64 + 1) as usize;
                bytes.extend_from_slice(&unsynced[..reached]);
            }
            "world.db-wal" if random_below(chance, 2) == 0 => continue,
            "world.db-shm" => continue,
            "snapshot.bin" => bytes.truncate(random_below(chance, 2 * bytes.len() as u64) as usize),
            _ => {}
        }
        std::fs::write(to.join(name.as_ref()), bytes).expect("written");
    }
}

#[test]
fn power_cut_keeps_confirmed_lines() {
    let runs = tempfile::tempdir().expect("a folder");
    let places = tempfile::tempdir().expect("a folder");
    let (mut session, cache) = new_session(NewRun { days: Some(200), ..new_run(runs.path()) });
    let mut chance = 5;
    for number in 0..30 {
        for _ in 0..random_below(&mut chance, 5) {
            act_randomly(&mut session, &mut chance).expect("the disk accepts the change");
        }
        if number % 3 == 2 {
            advance_week(&mut session);
        }
        let place = places.path().join(number.to_string());
        copy_after_power_cut(&session, &place, &cache, &mut chance);
        let resumed = Session::open(&place, Access::Write, true).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(resumed.journal(), session.journal(), "cut {number}");
        assert_eq!(resumed.state_hash(), session.state_hash(), "cut {number}");
        assert_eq!(resumed.notes().expect("notes"), session.notes().expect("notes"), "cut {number}");
    }
}

#[test]
fn power_cut_keeps_complete_weeks_of_headless_runs() {
    let runs = tempfile::tempdir().expect("a folder");
    let places = tempfile::tempdir().expect("a folder");
    let new = NewRun { days: Some(200), sync_calls: false, ..new_run(runs.path()) };
    let (mut session, cache) = new_session(new);
    let mut chance = 6;
    for number in 0..12 {
        advance_week(&mut session);
        let closed = session.state_hash();
        for _ in 0..random_below(&mut chance, 4) {
            let prices = json!({ "A": 5 + random_below(&mut chance, 20) });
            session.call("set_prices", &prices, Via::Policy).expect("prices");
        }
        if random_below(&mut chance, 2) == 0 {
            // A query of a policy returns the effects of its calls, so these calls must be synced first.
            session.query("SELECT COUNT(*) FROM config_history").expect("rows");
        }
        let place = places.path().join(number.to_string());
        copy_after_power_cut(&session, &place, &cache, &mut chance);
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
fn power_cut_after_failed_syncs_keeps_confirmed_lines() {
    let runs = tempfile::tempdir().expect("a folder");
    let places = tempfile::tempdir().expect("a folder");
    let (mut session, cache) = new_session(NewRun { days: Some(200), ..new_run(runs.path()) });
    let mut chance = 7;
    let (mut refused, mut unsaved_weeks) = (0, 0);
    for number in 0..30 {
        for _ in 0..random_below(&mut chance, 5) {
            cache.fail_next_syncs(random_below(&mut chance, 4) as u32);
            refused += u32::from(act_randomly(&mut session, &mut chance).is_err());
        }
        cache.fail_next_syncs(0);
        if number % 3 == 2 {
            let failing = random_below(&mut chance, 4) as u32;
            let forecasts = session.company().naive_forecasts();
            let week = session.advance("on", &forecasts, Via::Form, &mut |_| cache.fail_next_syncs(failing));
            let remark = week.expect("a week").remark;
            let is_unsaved = remark.is_some_and(|remark| remark.contains("simulated again"));
            assert_eq!(is_unsaved, failing >= 2, "{failing} syncs fail");
            unsaved_weeks += u32::from(is_unsaved);
        }
        let place = places.path().join(number.to_string());
        copy_after_power_cut(&session, &place, &cache, &mut chance);
        let resumed = Session::open(&place, Access::Write, true).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(resumed.journal(), session.journal(), "cut {number}");
        assert_eq!(resumed.state_hash(), session.state_hash(), "cut {number}");
    }
    assert!(refused > 0 && unsaved_weeks > 0, "{refused} {unsaved_weeks}");
}

#[test]
fn run_ends_even_if_its_last_lines_are_not_saved() {
    let runs = tempfile::tempdir().expect("a folder");
    let places = tempfile::tempdir().expect("a folder");
    let (mut session, cache) = new_session(NewRun { days: Some(28), ..new_run(runs.path()) });
    (0..3).for_each(|_| advance_week(&mut session));
    let forecasts = session.company().naive_forecasts();
    let last = session.advance("on", &forecasts, Via::Form, &mut |_| cache.set_full(true)).expect("a week");
    assert_eq!((last.ended, session.ended()), (Some(RunEndReason::Horizon), Some(RunEndReason::Horizon)));
    assert!(last.remark.expect("the disk is full").contains("simulated again"));
    let refused = session.advance("on", &forecasts, Via::Form, &mut |_| {}).expect_err("it is over");
    assert_eq!((refused.code, session.weeks().len(), session.day()), ("run_over", 4, 28));
    // No line can be recorded after an `end` line that is not on the disk.
    let afterwards = session.folder().expect("a folder").join("afterwards.jsonl");
    assert_eq!(session.set_notes("after the end").expect_err("the notes cannot be saved").code, "not_saved");
    assert!(!afterwards.exists());
    let mut chance = 3;
    let (before, after) = (places.path().join("before"), places.path().join("after"));
    copy_after_power_cut(&session, &before, &cache, &mut chance);
    cache.set_full(false);
    session.set_notes("after the end").expect("space is available again");
    assert!(afterwards.exists() && sync_probe::has_synced(&afterwards));
    copy_after_power_cut(&session, &after, &cache, &mut chance);
    let trajectory = Trajectory::read(&after.join("trajectory.jsonl")).expect("it reads");
    assert!(trajectory.end_line().is_some());
    for place in [before, after] {
        let resumed = Session::open(&place, Access::Write, true).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((resumed.ended(), resumed.score()), (session.ended(), session.score()));
        assert_eq!(resumed.weeks(), session.weeks());
        assert_eq!(resumed.state_hash(), session.state_hash());
    }
}

#[test]
fn abandon_fails_if_the_end_cannot_be_saved() {
    let runs = tempfile::tempdir().expect("a folder");
    let (mut session, cache) = new_session(NewRun { days: Some(28), ..new_run(runs.path()) });
    cache.fail_next_syncs(2);
    assert_eq!(session.abandon().expect_err("the disk fails").code, "not_saved");
    assert_eq!(session.ended(), None);
    advance_week(&mut session);
    session.abandon().expect("the run is abandoned");
    assert_eq!((session.ended(), session.score()), (Some(RunEndReason::Abandoned), None));
    assert!(Trajectory::parse(&cache.bytes_after_power_cut()).expect("it reads").end_line().is_some());
}

#[test]
fn folders_of_new_runs_and_archives_are_synced() {
    let place = tempfile::tempdir().expect("a folder");
    let runs = place.path().join("new/runs");
    sync_probe::reset(true);
    assert!(Session::create(new_run(&runs), &Configuration::bundled()).is_err());
    assert!(!place.path().join("new").exists(), "no folder remains");
    sync_probe::reset(false);
    let mut session = Session::create(new_run(&runs), &Configuration::bundled()).expect("a run");
    let folder = session.folder().expect("a folder").to_owned();
    for path in [runs.clone(), folder.clone(), folder.join("run.toml"), folder.join("trajectory.jsonl")] {
        assert!(sync_probe::has_synced(&path), "{}", path.display());
    }
    session.set_notes("kept").expect("kept");
    assert!(
        sync_probe::has_synced(&folder.join("memo.draft")) && sync_probe::has_synced(&folder.join("memo.md"))
    );
    advance_week(&mut session);
    session.save().expect("saved");
    drop(session);
    let archive = place.path().join("run.tar.gz");
    let export = Export::prepare(&folder, place.path(), &SealKey::default()).expect("a run");
    sync_probe::reset(true);
    assert!(export.write(&archive, false, None).is_err());
    sync_probe::reset(false);
    export.write(&archive, true, None).expect("an archive");
    assert!(sync_probe::has_synced(&archive));
    let other = place.path().join("other");
    let ImportOutcome::New(imported) = import_run(&other, &archive, None).expect("imported").2 else {
        panic!("it is new")
    };
    assert!(sync_probe::has_synced(&other) && sync_probe::has_synced(&imported));
}
