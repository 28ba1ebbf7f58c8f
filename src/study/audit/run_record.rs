//! Reads the runs in a machine's folder of runs.

use std::path::{Path, PathBuf};

use crate::definition::Study;
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::runs::all_run_folders;
use novamind_record::stamp::StudyStamp;
use novamind_record::trajectory::Trajectory;

/// A run that was read from its folder.
pub(super) struct RunRecord {
    pub id: String,
    pub folder: PathBuf,
    /// The manifest in the first line of the trajectory, or in `run.toml` if the line cannot be read.
    pub manifest: Option<Manifest>,
    pub trajectory: Result<Trajectory, RunError>,
}

/// Reads every run in a machine's folder of runs and in the folders of its participants, sorted by path.
pub(super) fn read_runs(base: &Path) -> Vec<RunRecord> {
    let folders = all_run_folders(base);
    let entries = |folder: &PathBuf| std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut places: Vec<PathBuf> = folders.iter().flat_map(entries).map(|entry| entry.path()).collect();
    places.sort_unstable();
    let is_run = |place: &PathBuf| place.is_dir() && place.file_name().is_some_and(|name| name.len() == 8);
    places.into_iter().filter(is_run).map(RunRecord::read).collect()
}

impl RunRecord {
    fn read(folder: PathBuf) -> RunRecord {
        let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let path = folder.join("trajectory.jsonl");
        let trajectory = Trajectory::read(&path);
        let first = trajectory.as_ref().ok().and_then(|trajectory| trajectory.lines.first());
        let manifest = Manifest::from_start_line(&path, first).ok();
        // The manifest may identify a run whose trajectory cannot be read.
        let manifest = manifest.or_else(|| Manifest::read(&folder).ok());
        RunRecord { id, folder, manifest, trajectory }
    }

    pub(super) fn stamp(&self) -> Option<&StudyStamp> {
        self.manifest.as_ref()?.study.as_ref()
    }

    /// Returns whether the run belongs to the study with this digest.
    pub(super) fn belongs_to_study(&self, study: &str) -> bool {
        self.stamp().is_some_and(|stamp| stamp.digest == study)
    }

    /// Returns whether the run belongs to a study with a different name.
    pub(super) fn belongs_to_different_study(&self, study: &Study) -> bool {
        self.stamp().is_some_and(|stamp| stamp.digest != study.digest && stamp.name != study.protocol.name)
    }
}
