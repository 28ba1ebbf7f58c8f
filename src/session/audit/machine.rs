//! What there is on a machine: its runs, its list of opened worlds, its list of visits.

use std::path::{Path, PathBuf};

use crate::session::error::RunError;
use crate::session::folder::manifest::Manifest;
use crate::session::folder::runs::all_run_folders;
use crate::session::folder::world_log::{WORLDS, WorldLog};
use crate::session::study::tombstone::Tombstone;
use crate::session::trajectory::Trajectory;

/// A machine's folder of runs, or a copy of it.
pub(super) struct MachineRecord {
    pub runs: Vec<RunRecord>,
    pub worlds: WorldLog,
    /// Runs whose participants have withdrawn.
    pub withdrawn: Vec<String>,
}

/// A run in it.
pub(super) struct RunRecord {
    pub id: String,
    pub folder: PathBuf,
    /// What the first line says it is; none where it cannot be read.
    pub manifest: Option<Manifest>,
    pub trajectory: Result<Trajectory, RunError>,
}

impl MachineRecord {
    pub(super) fn read(base: &Path) -> MachineRecord {
        let folders = all_run_folders(base);
        let entries = |folder: &PathBuf| std::fs::read_dir(folder).into_iter().flatten().flatten();
        let mut places: Vec<PathBuf> = folders.iter().flat_map(entries).map(|entry| entry.path()).collect();
        places.sort_unstable();
        let is_run =
            |place: &PathBuf| place.is_dir() && place.file_name().is_some_and(|name| name.len() == 8);
        let runs = places.into_iter().filter(is_run).map(RunRecord::read).collect();
        let stones: Vec<Tombstone> = folders.iter().filter_map(|folder| Tombstone::read(folder)).collect();
        let withdrawn = stones.iter().flat_map(Tombstone::runs).map(str::to_owned).collect();
        MachineRecord { runs, worlds: WorldLog::read(&base.join(WORLDS)), withdrawn }
    }
}

impl RunRecord {
    fn read(folder: PathBuf) -> RunRecord {
        let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let path = folder.join("trajectory.jsonl");
        let trajectory = Trajectory::read(&path);
        let first = trajectory.as_ref().ok().and_then(|trajectory| trajectory.lines.first());
        let manifest = Manifest::of_start(&path, first).ok();
        // What cannot be read may still say whose it was.
        let manifest = manifest.or_else(|| Manifest::read(&folder).ok());
        RunRecord { id, folder, manifest, trajectory }
    }

    /// Whether it is a run of a study.
    pub(super) fn is_of(&self, study: &str) -> bool {
        self.manifest
            .as_ref()
            .and_then(|manifest| manifest.study.as_ref())
            .is_some_and(|stamp| stamp.digest == study)
    }
}
