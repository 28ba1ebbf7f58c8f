//! The source of a recorded run: files, manifest and initial parameters.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::play::Session;
use novamind_database::{DatabaseLocation, Projector};
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::{ManifestCheck, check_start};
use novamind_record::trajectory::record::Activity;
use novamind_record::trajectory::{Line, Record, Trajectory};
use novamind_world::params::Params;

/// The source of recorded lines: a run folder or a trajectory file.
pub struct Origin {
    /// Path of the trajectory file.
    pub path: PathBuf,
    /// Folder of the run; `None` for a trajectory without a run folder.
    pub folder: Option<PathBuf>,
    /// Manifest of the run.
    pub manifest: Manifest,
    /// Parameters at the start of the run.
    pub params: Arc<Params>,
}

impl Origin {
    /// Creates a session before the first line, with a database in memory.
    pub(crate) fn initial_session(&self) -> Result<Session, RunError> {
        let (projector, _) =
            Projector::start(DatabaseLocation::new_in_memory(), 0, self.params.clone(), |_| false)?;
        let (manifest, params) = (self.manifest.clone(), self.params.clone());
        Ok(Session::new_read_only(manifest, self.folder.clone(), params, Some(projector)))
    }

    /// Replays recorded lines in memory. Calls `after_line` with the session after each line. If `has_database` is
    /// true, the database is up to date at each `lesson` line.
    ///
    /// # Errors
    /// A line does not reproduce the recorded state, or `after_line` returns an error.
    pub fn replay(
        &self,
        lines: &[Line],
        has_database: bool,
        after_line: &mut dyn FnMut(&mut Session, &Line) -> Result<(), RunError>,
    ) -> Result<Session, RunError> {
        let start = || Projector::start(DatabaseLocation::new_in_memory(), 0, self.params.clone(), |_| false);
        let projector = has_database.then(start).transpose()?.map(|(projector, _)| projector);
        let mut session = Session::new_read_only(self.manifest.clone(), None, self.params.clone(), projector);
        for line in lines {
            session.apply_line(&self.path, line)?;
            if has_database && matches!(line.record, Record::Activity(Activity::Lesson(_))) {
                session.commit_projection();
            }
            after_line(&mut session, line)?;
        }
        Ok(session)
    }
}

/// Reads the lines of a run folder, or of a trajectory file without a run folder.
pub fn read_origin(path: &Path) -> Result<(Origin, Trajectory), RunError> {
    let (file, folder) = match path.is_dir() {
        true => (path.join("trajectory.jsonl"), Some(path.to_owned())),
        false => {
            let parent_folder = path
                .parent()
                .map(|parent| if parent.as_os_str().is_empty() { Path::new(".") } else { parent });
            let is_of_run = path.file_name().is_some_and(|name| name == "trajectory.jsonl");
            let folder = parent_folder.filter(|folder| is_of_run && folder.join("run.toml").exists());
            (path.to_owned(), folder.map(Path::to_owned))
        }
    };
    let trajectory = Trajectory::read(&file)?;
    let manifest = match &folder {
        Some(folder) => ManifestCheck::read(folder)?.manifest,
        None => Manifest::from_start_line(&file, trajectory.lines.first())?,
    };
    check_start(&file, trajectory.lines.first(), &manifest)?;
    let params = Arc::new(manifest.load_params()?);
    Ok((Origin { path: file, folder, manifest, params }, trajectory))
}
