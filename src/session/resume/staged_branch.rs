//! Branches under construction. A new branch is in a staging folder that is not listed as a run. The folder is renamed
//! when the branch is complete. If the program stops earlier, no incomplete run is listed.

use std::path::{Path, PathBuf};

use crate::play::Session;
use crate::play::open::Access;
use crate::recording::folders::remove_stale_staging_folders;
use novamind_record::error::RunError;
use novamind_record::files::{create_folder, sync_folder};
use novamind_record::folder::lock::lock_run;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest::to_start_record;
use novamind_record::folder::runs::STAGING_PREFIX;
use novamind_record::lesson::Lesson;
use novamind_record::trajectory::record::Branch;
use novamind_record::trajectory::{Durability, Line, Record, TrajectoryWriter};

/// A branch in a staging folder, which is removed on drop unless the branch was published.
pub struct StagedBranch {
    folder: PathBuf,
    final_folder: PathBuf,
}

impl StagedBranch {
    /// Creates a branch in a staging folder next to its parent: manifest, copied lines and the `branch` line.
    ///
    /// # Errors
    /// A file cannot be written. After an error, no folder remains.
    pub(crate) fn create(
        parent: &Path,
        manifest: &Manifest,
        shared: &[&Line],
    ) -> Result<StagedBranch, RunError> {
        parent.parent().into_iter().for_each(remove_stale_staging_folders);
        let published_folder = parent.with_file_name(&manifest.id);
        let folder = parent.with_file_name(format!("{STAGING_PREFIX}{}", manifest.id));
        let branch = StagedBranch { folder, final_folder: published_folder };
        branch.write_files(manifest, shared)?;
        if let Some(stamp) = &manifest.lesson {
            Lesson::from_run(parent, &stamp.name)?.write_to_run(&branch.folder)?;
        }
        Ok(branch)
    }

    fn write_files(&self, manifest: &Manifest, shared: &[&Line]) -> Result<(), RunError> {
        let folder = &self.folder;
        create_folder(folder)?;
        let _lock = lock_run(folder, &manifest.id)?;
        write_branch_files(folder, manifest, shared)
    }

    /// Opens the branch while it is in its staging folder.
    ///
    /// # Errors
    /// The branch cannot be opened.
    pub fn open(&self) -> Result<Session, RunError> {
        Session::open(&self.folder, Access::Write, true)
    }

    /// Publishes the branch as a run and opens the run. No other session may have the branch open.
    ///
    /// # Errors
    /// The folder cannot be renamed, or the branch cannot be opened. After an error, no branch remains.
    pub fn publish(self) -> Result<Session, RunError> {
        let StagedBranch { folder, final_folder: published_folder } = &self;
        std::fs::rename(folder, published_folder).map_err(RunError::io(published_folder))?;
        let opened = published_folder
            .parent()
            .map_or(Ok(()), sync_folder)
            .and_then(|()| Session::open(published_folder, Access::Write, true));
        if opened.is_err() {
            drop(std::fs::remove_dir_all(published_folder));
        }
        opened
    }
}

/// Writes the files of a branch to its folder: manifest, copied lines and the `branch` line.
///
/// # Errors
/// A file cannot be written.
pub(super) fn write_branch_files(
    folder: &Path,
    manifest: &Manifest,
    shared: &[&Line],
) -> Result<(), RunError> {
    manifest.write(folder)?;
    let mut writer = TrajectoryWriter::create(&folder.join("trajectory.jsonl"))?;
    writer.append(0, &to_start_record(manifest), Durability::Written)?;
    for line in shared {
        writer.append_copy(line)?;
    }
    let day = shared.last().map_or(0, |line| line.day);
    let branch = Branch { from: manifest.parent.clone() };
    writer.append(day, &Record::Branch(branch), Durability::Synced)?;
    Ok(())
}

impl Drop for StagedBranch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
