//! Temporary folders that are removed on drop and when a signal ends the program.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use crate::recording::folders::new_run_id;
use novamind_record::error::RunError;
use novamind_record::files::create_folder;

/// A hidden temporary folder next to the final files. The folder is never listed as a run and is removed on drop.
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
    /// The folder cannot be written, or the program is about to exit.
    pub fn create_in(folder: &Path) -> Result<TemporaryFolder, RunError> {
        create_folder(folder)?;
        let path = folder.join(format!(".novamind-{}", new_run_id()));
        let mut open = lock_open_folders();
        if open.is_closed {
            return Err(RunError::InvalidRequest("the program is about to exit".to_owned()));
        }
        std::fs::create_dir(&path).map_err(RunError::io(&path))?;
        open.folders.push(path.clone());
        Ok(TemporaryFolder(path))
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        lock_open_folders().folders.retain(|folder| *folder != self.0);
        // Ignore the error: a hidden folder that remains is harmless.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Maximum number of attempts to remove a temporary folder to which another thread may still be writing.
const MAX_REMOVAL_ATTEMPTS: usize = 100;

/// Removes all temporary folders and prevents the creation of new ones. Called when a signal is about to end the
/// program.
pub fn remove_temporary_folders() {
    let folders = {
        let mut open = lock_open_folders();
        open.is_closed = true;
        std::mem::take(&mut open.folders)
    };
    for folder in folders {
        // The removal fails if another thread creates a file at the same time, so try again.
        let _ =
            (0..MAX_REMOVAL_ATTEMPTS).find(|_| std::fs::remove_dir_all(&folder).is_ok() || !folder.exists());
    }
}
