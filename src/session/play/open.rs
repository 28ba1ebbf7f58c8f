//! Opening of runs: reading the trajectory and simulating the run again.

use std::path::Path;
use std::sync::Arc;

use super::Session;
use crate::database::RunDatabase;
use crate::recording::folders::remove_stale_staging_folders;
use crate::recording::recorder::Recorder;
use crate::snapshot::integrity::Integrity;
use crate::snapshot::sealing::SealKey;
use novamind_database::{DatabaseLocation, ProjectionPosition, Projector};
use novamind_record::error::RunError;
use novamind_record::folder::lock::lock_run;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::{ManifestCheck, check_start};
use novamind_record::folder::runs::find_run;
use novamind_record::trajectory::Trajectory;
use novamind_world::params::Params;

/// Access to an opened run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Play the run. Only one program at a time has this access.
    Write,
    /// Read the run without changing its files.
    Read,
}

/// Functions that store the results of a simulation, so that the next read-only command does not need to repeat the
/// simulation.
#[derive(Clone, Copy)]
pub(crate) struct StoreFunctions {
    /// Returns whether the state at the end of the run may be stored.
    pub(crate) may_store: fn(&Path, &Manifest, &Trajectory, &SealKey) -> bool,
    /// Stores the snapshot and the database. Returns whether both were stored.
    pub(crate) store_database: fn(&Path, &SealKey) -> bool,
    pub(crate) store_snapshot: fn(&Session, &Path),
}

impl Session {
    /// Opens the run in a folder and simulates it up to its last line.
    ///
    /// # Errors
    /// The run is missing, damaged, recorded with another version, or in use. The error names the file and the data
    /// that is safe.
    pub fn open(folder: &Path, access: Access, projection: bool) -> Result<Session, RunError> {
        Session::open_sealed(folder, access, projection, SealKey::default())
    }

    /// Opens a run like [`Session::open`]. The snapshots of the run are sealed with `key`.
    ///
    /// # Errors
    /// The same errors as [`Session::open`].
    pub fn open_sealed(
        folder: &Path,
        access: Access,
        projection: bool,
        key: SealKey,
    ) -> Result<Session, RunError> {
        Session::open_with_cache(folder, access, projection, key, None)
    }

    /// Opens a run like [`Session::open_sealed`]. If `store_functions` is set, stores the simulated state and the
    /// database for later read-only commands.
    ///
    /// # Errors
    /// The same errors as [`Session::open`].
    pub(crate) fn open_with_cache(
        folder: &Path,
        access: Access,
        projection: bool,
        key: SealKey,
        store_functions: Option<StoreFunctions>,
    ) -> Result<Session, RunError> {
        let derived = ManifestCheck::read(folder)?;
        let manifest = derived.manifest.clone();
        let params = Arc::new(manifest.load_params()?);
        let (lock, restored) = match access {
            Access::Write => {
                let lock = lock_run(folder, &manifest.id)?;
                folder.parent().into_iter().for_each(remove_stale_staging_folders);
                (Some(lock), derived.repair_manifest(folder)?)
            }
            Access::Read => (
                None,
                derived
                    .problem
                    .map(|problem| format!("{problem}: the first line of the trajectory is used instead.")),
            ),
        };
        let path = folder.join("trajectory.jsonl");
        let mut integrity = Integrity::read(folder, &manifest, &key);
        let trajectory = Trajectory::read(&path)?;
        check_start(&path, trajectory.lines.first(), &manifest)?;
        integrity.check(&path, &trajectory)?;
        let finished = (projection && access == Access::Read)
            .then(|| integrity.finished_database(folder, &trajectory))
            .flatten();
        let keeping = store_functions
            .filter(|cache_functions| (cache_functions.may_store)(folder, &manifest, &trajectory, &key));
        let simulates = projection && finished.is_none();
        if simulates && keeping.is_some_and(|functions| (functions.store_database)(folder, &key)) {
            return Session::open_sealed(folder, access, projection, key);
        }
        let database = match projection && finished.is_none() {
            false => None,
            true => {
                let sound = access == Access::Write && integrity.check_database(folder);
                Some(open_projector(folder, access, (&manifest, &params), &trajectory, sound)?)
            }
        };
        // The database has rows up to this line. To add missing rows, the replay must start at or before this line.
        let rows = database.as_ref().map(|(_, rows)| rows.as_ref().map_or(0, |position| position.seq));
        let snapshot = integrity.usable_snapshot(&manifest, &trajectory, rows);
        let lines = &trajectory.lines;
        let (mut session, seen) = Session::prepare_replay(manifest.clone(), folder, params, lines, snapshot);
        session.seal_key = key;
        session.remarks.extend(restored);
        session.remarks.append(&mut integrity.remarks);
        session.replay(&path, &trajectory, seen, database, &mut |_| {})?;
        if let Some(cache) = keeping.filter(|_| !projection && seen < trajectory.lines.len()) {
            (cache.store_snapshot)(&session, folder);
        }
        if let Some(location) = finished {
            session.database = RunDatabase::from_file(location, session.params().fidelity.interface);
        }
        if let Some(lock) = lock {
            session.log.set_recorder(Recorder::resume(&path, &trajectory, lock)?);
        }
        if trajectory.unfinished_bytes > 0 {
            let bytes = trajectory.unfinished_bytes;
            let reason = match integrity.is_database_ahead_of(&trajectory) {
                true => {
                    ". world.db contains the complete line: a power cut or an edit removed the end of the line."
                }
                false => ": this line was never confirmed.",
            };
            session.remarks.push(format!(
                "The last line of the trajectory was unfinished ({bytes} bytes) and was dropped{reason}"
            ));
        }
        session.log.load(&trajectory);
        session.replay_afterwards(&trajectory);
        session.check_notes(&trajectory, access);
        session.resume_lesson(folder, &trajectory.lines)?;
        session.finish_week(&trajectory);
        session.finish_start(&trajectory.lines)?;
        session.report_python_calculations();
        Ok(session)
    }
}

/// Starts the database. Uses the existing contents only if `is_intact` is true, that is, if the file passed its
/// integrity check.
pub(crate) fn open_projector(
    folder: &Path,
    access: Access,
    (manifest, params): (&Manifest, &Arc<Params>),
    trajectory: &Trajectory,
    is_intact: bool,
) -> Result<(Projector, Option<ProjectionPosition>), RunError> {
    let location = match access {
        Access::Write => DatabaseLocation::File(folder.join("world.db")),
        // Another program may be writing the file, so a read-only session creates a database in memory.
        Access::Read => DatabaseLocation::new_in_memory(),
    };
    let known = |position: &ProjectionPosition| {
        let line = trajectory.lines.get(position.seq as usize);
        is_intact && line.is_some_and(|line| line.hash == position.line_hash)
    };
    Ok(Projector::start(location, manifest.id_number(), params.clone(), known)?)
}

/// Abandons an unfinished run permanently.
///
/// # Errors
/// The run has ended already, is in use, or cannot be read.
pub fn abandon_run(runs: &Path, id: &str) -> Result<(), RunError> {
    let mut session = Session::open(&find_run(runs, id)?, Access::Write, false)?;
    session.abandon().map_err(|rejection| RunError::InvalidRequest(rejection.message))
}
