//! Rebuilding of the database file of a stored run. The trajectory of the run is only read.

use std::path::Path;
use std::sync::Arc;

use crate::permission::can_inspect;
use crate::play::Session;
use crate::play::open::{Access, StoreFunctions, open_projector};
use crate::snapshot::file::SnapshotTarget;
use crate::snapshot::integrity::{Integrity, is_database_unchanged};
use crate::snapshot::sealing::SealKey;
use novamind_database::{DatabaseLocation, ProjectionPosition, QueryConnection, Scope, query_connection};
use novamind_record::error::RunError;
use novamind_record::folder::lock::lock_run;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::{ManifestCheck, check_start};
use novamind_record::trajectory::{Record, Trajectory};
use novamind_tools::Rejection;

/// Updates `world.db` up to the last line of the trajectory, or rebuilds the file. Calls `progress` with the current
/// day and the last day of the run. `key` is the seal key of the run's snapshots.
///
/// # Errors
/// The run is damaged, was recorded with another version or is in use, or its folder cannot be written.
pub fn rebuild_database(
    folder: &Path,
    key: &SealKey,
    progress: &mut dyn FnMut(u32, u32),
) -> Result<(), RunError> {
    let ManifestCheck { manifest, .. } = ManifestCheck::read(folder)?;
    let params = Arc::new(manifest.load_params()?);
    let _lock = lock_run(folder, &manifest.id)?;
    let path = folder.join("trajectory.jsonl");
    let mut integrity = Integrity::read(folder, &manifest, key);
    let trajectory = Trajectory::read(&path)?;
    check_start(&path, trajectory.lines.first(), &manifest)?;
    integrity.check(&path, &trajectory)?;
    let sound = integrity.check_database(folder);
    let database = open_projector(folder, Access::Write, (&manifest, &params), &trajectory, sound)?;
    let rows = database.1.as_ref().map_or(0, |position| position.seq);
    let snapshot = integrity.usable_snapshot(&manifest, &trajectory, Some(rows));
    let days = manifest.days;
    let lines = &trajectory.lines;
    let (mut session, seen) = Session::prepare_replay(manifest.clone(), folder, params, lines, snapshot);
    session.replay(&path, &trajectory, seen, Some(database), &mut |day| progress(day, days))?;
    session.database().wait_until_written()?;
    let place = SnapshotTarget::new(folder, key);
    if may_store_final_snapshot(folder, &manifest, &trajectory, key) {
        session.write_snapshot(place, true);
    } else if let Some(closed) = integrity.snapshot.filter(|snapshot| snapshot.database().is_some()) {
        // The database file has changed: update its digest in the snapshot.
        session.database().after_writes(true, move |digest| closed.certify_database(&place, digest));
    }
    Ok(session.database().wait_until_written()?)
}

/// Returns whether a read-only command may store a snapshot of the end of a run. The run must have ended, and showing
/// its hidden state must be allowed. An existing snapshot must not be sealed with the secret of a study.
fn may_store_final_snapshot(
    folder: &Path,
    manifest: &Manifest,
    trajectory: &Trajectory,
    key: &SealKey,
) -> bool {
    let ended = trajectory.end_line().and_then(|line| match &line.record {
        Record::End(end) => Some(end.reason),
        _ => None,
    });
    ended.is_some() && can_inspect(manifest, ended, Some(folder)) && SnapshotTarget::may_write(folder, key)
}

/// Opens a connection to the existing database file of a run. Also returns the position of the last trajectory line
/// that the database includes. `key` is the seal key of the run's snapshots.
///
/// # Errors
/// The file is missing, is not the database of a run, or was changed after the run was closed.
pub fn open_database_file(
    folder: &Path,
    key: &SealKey,
) -> Result<(QueryConnection, ProjectionPosition), Rejection> {
    if !is_database_unchanged(folder, key) {
        return Err(Rejection::new("sql_error", "world.db was changed after the run was closed"));
    }
    let error = |error: &dyn std::fmt::Display| Rejection::new("sql_error", error.to_string());
    let params = ManifestCheck::read(folder).and_then(|check| check.manifest.load_params());
    let interface = params.map_err(|problem| error(&problem))?.fidelity.interface;
    query_connection(&DatabaseLocation::File(folder.join("world.db")), interface, Scope::Visible)
        .map_err(|problem| error(&problem))
}

impl Session {
    /// Opens a run read-only. If the run has ended and had to be simulated, stores a snapshot and the database in the
    /// run folder. The next command then opens the run immediately.
    ///
    /// # Errors
    /// The same errors as [`Session::open`].
    pub fn open_to_read(folder: &Path, projection: bool) -> Result<Session, RunError> {
        let keeping = StoreFunctions {
            may_store: may_store_final_snapshot,
            store_database: |folder, key| rebuild_database(folder, key, &mut |_, _| {}).is_ok(),
            store_snapshot: Session::store_final_snapshot,
        };
        Session::open_with_cache(folder, Access::Read, projection, SealKey::default(), Some(keeping))
    }

    /// Writes the snapshot of an ended run that a read-only command has simulated. Does nothing if the run is in use,
    /// or if its folder cannot be written.
    fn store_final_snapshot(&self, folder: &Path) {
        if let Ok(_lock) = lock_run(folder, &self.manifest().id) {
            self.write_snapshot(SnapshotTarget::new(folder, self.seal_key()), false);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::create::{NewRun, Storage};
    use crate::play::open::abandon_run;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::mode::Mode;
    use novamind_record::trajectory::record::Via;

    const DERIVED_FILES: [&str; 2] = ["snapshot.bin", "world.db"];

    /// Creates a run of two weeks and deletes its derived files, as after an import.
    fn run_without_derived_files(runs: &Path, mode: Mode, ends: bool) -> PathBuf {
        let storage = Storage::Runs(runs.to_owned());
        let participant = Some("P01".to_owned());
        let days = (mode != Mode::Baseline).then_some(28);
        let new = NewRun { seed: Some(5), days, mode, participant, storage, ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        for _ in 0..2 {
            let forecasts = session.company().naive_forecasts();
            session.advance("on", &forecasts, Via::Form, &mut |_| {}).expect("a week");
        }
        let (folder, id) = (session.folder().expect("a folder").to_owned(), session.manifest().id.clone());
        drop(session);
        if ends {
            abandon_run(runs, &id).expect("it ends");
        }
        for file in ["world.db-wal", "world.db-shm"].into_iter().chain(DERIVED_FILES) {
            let _ = std::fs::remove_file(folder.join(file));
        }
        folder
    }

    fn derived_files(folder: &Path) -> Vec<&'static str> {
        DERIVED_FILES.into_iter().filter(|file| folder.join(file).exists()).collect()
    }

    /// Returns the number of lines that the next command has to simulate, and whether that command uses the database
    /// file.
    fn next_open_cost(folder: &Path) -> (usize, bool) {
        let manifest = ManifestCheck::read(folder).expect("a manifest").manifest;
        let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).expect("a trajectory");
        let integrity = Integrity::read(folder, &manifest, &SealKey::default());
        assert_eq!(integrity.remarks, Vec::<String>::new());
        let params = Arc::new(manifest.load_params().expect("parameters"));
        let snapshot = integrity.usable_snapshot(&manifest, &trajectory, None);
        let (_, seen) = Session::prepare_replay(manifest, folder, params, &trajectory.lines, snapshot);
        (trajectory.lines.len() - seen, integrity.finished_database(folder, &trajectory).is_some())
    }

    #[test]
    fn open_to_read_simulates_an_ended_run_only_once() {
        for mode in [Mode::Sandbox, Mode::Baseline] {
            let runs = tempfile::tempdir().expect("a folder");
            let folder = run_without_derived_files(runs.path(), mode, true);
            let whole = Session::open(&folder, Access::Read, true).expect("it opens");
            assert_eq!(derived_files(&folder), [""; 0], "Session::open writes nothing");
            let first = Session::open_to_read(&folder, true).expect("it opens");
            assert_eq!(
                (derived_files(&folder), next_open_cost(&folder)),
                (DERIVED_FILES.to_vec(), (0, true))
            );
            let second = Session::open_to_read(&folder, true).expect("it opens");
            for session in [&first, &second] {
                assert_eq!(session.state_hash(), whole.state_hash());
                assert_eq!(
                    (session.remarks(), session.company().dashboard()),
                    (whole.remarks(), whole.company().dashboard())
                );
                assert_eq!(session.weeks(), whole.weeks());
            }
            drop(Session::open(&folder, Access::Write, true).expect("it opens to be written"));
        }
    }

    #[test]
    fn open_to_read_without_database_stores_only_the_snapshot() {
        let runs = tempfile::tempdir().expect("a folder");
        let folder = run_without_derived_files(runs.path(), Mode::Sandbox, true);
        Session::open_to_read(&folder, false).expect("it opens");
        assert_eq!((derived_files(&folder), next_open_cost(&folder)), (vec!["snapshot.bin"], (0, false)));
        // The database is stored when a command needs it.
        Session::open_to_read(&folder, true).expect("it opens");
        assert_eq!((derived_files(&folder), next_open_cost(&folder)), (DERIVED_FILES.to_vec(), (0, true)));
    }

    #[test]
    fn query_stores_the_end_of_a_run() {
        let runs = tempfile::tempdir().expect("a folder");
        let folder = run_without_derived_files(runs.path(), Mode::Sandbox, true);
        rebuild_database(&folder, &SealKey::default(), &mut |_, _| {}).expect("a database");
        assert_eq!(next_open_cost(&folder), (0, true));
    }

    #[test]
    fn open_to_read_stores_nothing_for_unfinished_runs_and_runs_in_use() {
        let runs = tempfile::tempdir().expect("a folder");
        for projection in [false, true] {
            let unfinished = run_without_derived_files(runs.path(), Mode::Baseline, false);
            Session::open_to_read(&unfinished, projection).expect("it opens");
            assert_eq!(derived_files(&unfinished), [""; 0]);
            let used = run_without_derived_files(runs.path(), Mode::Sandbox, true);
            let id = used.file_name().expect("a name").to_string_lossy().into_owned();
            let lock = lock_run(&used, &id).expect("a lock");
            Session::open_to_read(&used, projection).expect("it opens");
            assert_eq!(derived_files(&used), [""; 0]);
            drop(lock);
        }
    }

    #[test]
    fn open_to_read_keeps_snapshots_sealed_with_a_study_secret() {
        let runs = tempfile::tempdir().expect("a folder");
        let folder = run_without_derived_files(runs.path(), Mode::Sandbox, true);
        let key = SealKey::with_study_secret(&[7; 32]);
        let mut session = Session::open_sealed(&folder, Access::Write, true, key).expect("it opens");
        session.save().expect("it is saved");
        drop(session);
        let sealed = std::fs::read(folder.join("snapshot.bin")).expect("a snapshot");
        for projection in [false, true] {
            Session::open_to_read(&folder, projection).expect("it opens");
            assert!(std::fs::read(folder.join("snapshot.bin")).expect("a snapshot") == sealed);
        }
    }
}
