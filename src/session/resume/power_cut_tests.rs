//! Power cuts: whatever was not synced is gone, and nothing that was confirmed is
//! (docs/formats/trajectory.md#durability).

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Arc, Mutex};

use serde_json::json;

use super::open::Access;
use crate::session::folder::configuration::Configuration;
use crate::session::folder::create::{NewRun, Storage};
use crate::session::state::Session;
use crate::session::trajectory::Medium;
use crate::session::trajectory::record::Via;

/// A file that keeps what was not synced in memory, where a power cut takes it.
struct Volatile {
    file: File,
    unsynced: Arc<Mutex<Vec<u8>>>,
}

impl Medium for Volatile {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.unsynced.lock().expect("a lock").extend_from_slice(bytes);
        Ok(())
    }

    fn sync(&self) -> io::Result<()> {
        let mut unsynced = self.unsynced.lock().expect("a lock");
        (&self.file).write_all(&unsynced)?;
        unsynced.clear();
        Ok(())
    }

    fn cut(&mut self, _length: u64) -> io::Result<()> {
        unreachable!("this file never refuses")
    }

    fn is_ours(&self, _path: &Path, _length: u64) -> bool {
        true
    }

    fn beginning(&mut self, _length: u64) -> io::Result<Vec<u8>> {
        unreachable!("this file is never taken away")
    }
}

fn session(runs: &Path, sync_calls: bool) -> (Session, Arc<Mutex<Vec<u8>>>) {
    let storage = Storage::Runs(runs.to_owned());
    let new = NewRun { seed: Some(8), days: Some(200), storage, sync_calls, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
    let path = session.folder().expect("a folder").join("trajectory.jsonl");
    let file = File::options().append(true).open(path).expect("a file");
    let unsynced = Arc::new(Mutex::new(Vec::new()));
    let medium = Volatile { file, unsynced: unsynced.clone() };
    session.recorder.as_mut().expect("it is written").write_to(Box::new(medium));
    (session, unsynced)
}

/// A number below `sides`.
fn roll(state: &mut u64, sides: u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) % sides
}

fn act(session: &mut Session, chance: &mut u64) {
    match roll(chance, 6) {
        0 => drop(session.query("SELECT COUNT(*) FROM ledger")),
        1 => session.note_view("cash", "overview", 900),
        2 => session.set_memo(&format!("note {}", roll(chance, 100))).expect("kept"),
        _ => {
            let prices = json!({ "A": 5 + roll(chance, 20), "B": 30 });
            session.call("set_prices", &prices, Via::Form).expect("prices");
        }
    }
}

fn week(session: &mut Session) {
    let forecasts = session.naive_forecasts();
    session.advance("on", &forecasts, Via::Form, &mut |_| {}).expect("a week");
}

/// The run's folder as a disk shows it after the cut: a part of what was not synced may have reached it, in any file.
fn after_the_cut(session: &Session, to: &Path, unsynced: &[u8], chance: &mut u64) {
    let folder = session.folder().expect("a folder");
    // The database's own care for power cuts is SQLite's affair; here its files are copied while they rest.
    session.projection.wait().expect("it is written");
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let mut bytes = std::fs::read(entry.path()).expect("bytes");
        match name.as_ref() {
            "trajectory.jsonl" => {
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
    let (mut session, unsynced) = session(runs.path(), true);
    let mut chance = 5;
    for number in 0..30 {
        for _ in 0..roll(&mut chance, 5) {
            act(&mut session, &mut chance);
        }
        if number % 3 == 2 {
            week(&mut session);
        }
        let place = places.path().join(number.to_string());
        after_the_cut(&session, &place, &unsynced.lock().expect("a lock"), &mut chance);
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
    let (mut session, unsynced) = session(runs.path(), false);
    let mut chance = 6;
    for number in 0..12 {
        week(&mut session);
        let closed = session.state_hash();
        for _ in 0..roll(&mut chance, 4) {
            let prices = json!({ "A": 5 + roll(&mut chance, 20) });
            session.call("set_prices", &prices, Via::Policy).expect("prices");
        }
        if roll(&mut chance, 2) == 0 {
            // A policy that asks gets what it has done; the database never knows more than the disk.
            session.query("SELECT COUNT(*) FROM config_history").expect("rows");
        }
        let place = places.path().join(number.to_string());
        after_the_cut(&session, &place, &unsynced.lock().expect("a lock"), &mut chance);
        let resumed = Session::open(&place, Access::Write, true).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(resumed.weeks(), session.weeks(), "cut {number}");
        if resumed.journal().len() == session.journal().len() {
            assert_eq!(resumed.state_hash(), session.state_hash(), "cut {number}");
        } else if !matches!(
            resumed.journal().last(),
            Some(crate::session::figures::journal::JournalEntry::Call { .. })
        ) {
            assert_eq!(resumed.state_hash(), closed, "cut {number}");
        }
    }
}
