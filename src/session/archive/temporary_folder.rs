//! Temporary folders.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use crate::recording::folders::new_run_id;
use novamind_record::error::RunError;
use novamind_record::files::create_folder;

/// A hidden temporary folder next to the final files. It is never listed as a run and is removed on drop.
pub struct TemporaryFolder(PathBuf);

struct OpenFolders {
    folders: Vec<PathBuf>,
    is_closed: bool,
}

static OPEN_FOLDERS: Mutex<OpenFolders> = Mutex::new(OpenFolders { folders: Vec::new(), is_closed: false });

fn lock_open_folders() -> MutexGuard<'static, OpenFolders> {
    OPEN_FOLDERS.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

impl TemporaryFolder {
    /// Creates a temporary folder in `folder`.
    ///
    /// # Errors
    /// The folder cannot be written, or the program is about to end.
    pub fn create_in(folder: &Path) -> Result<TemporaryFolder, RunError> {
        create_folder(folder)?;
        let path = folder.join(format!(".novamind-{}", new_run_id()));
        let mut open = lock_open_folders();
        if open.is_closed {
            return Err(RunError::InvalidRequest("the program is about to end".to_owned()));
        }
        std::fs::create_dir(&path).map_err(RunError::io(&path))?;
        open.folders.push(path.clone());
        Ok(TemporaryFolder(path))
    }

    /// Returns its path.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        lock_open_folders().folders.retain(|folder| *folder != self.0);
        // A hidden folder that cannot be removed does no harm.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Attempts to remove a temporary folder that another thread may still be writing.
const MAX_REMOVAL_ATTEMPTS: usize = 100;

/// Removes all temporary folders and prevents new ones. Called when a signal is about to end the program.
pub fn remove_temporary_folders() {
    let folders = {
        let mut open = lock_open_folders();
        open.is_closed = true;
        std::mem::take(&mut open.folders)
    };
    for folder in folders {
        // A file created while the folder is being removed makes the removal fail; try again.
        let _ =
            (0..MAX_REMOVAL_ATTEMPTS).find(|_| std::fs::remove_dir_all(&folder).is_ok() || !folder.exists());
    }
}
