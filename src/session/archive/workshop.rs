//! Temporary folders.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use crate::recording::folders::new_id;
use novamind_record::error::RunError;
use novamind_record::files::create_folder;

/// A hidden temporary folder next to the final files. It is never listed as a run and is removed on drop.
pub struct Workshop(PathBuf);

struct Open {
    folders: Vec<PathBuf>,
    closed: bool,
}

static OPEN: Mutex<Open> = Mutex::new(Open { folders: Vec::new(), closed: false });

fn open() -> MutexGuard<'static, Open> {
    OPEN.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

impl Workshop {
    /// Creates a temporary folder in `folder`.
    ///
    /// # Errors
    /// The folder cannot be written, or the program is about to end.
    pub fn within(folder: &Path) -> Result<Workshop, RunError> {
        create_folder(folder)?;
        let own = folder.join(format!(".novamind-{}", new_id()));
        let mut open = open();
        if open.closed {
            return Err(RunError::NotPossible("the program is about to end".to_owned()));
        }
        std::fs::create_dir(&own).map_err(RunError::io(&own))?;
        open.folders.push(own.clone());
        Ok(Workshop(own))
    }

    /// Returns its path.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Workshop {
    fn drop(&mut self) {
        open().folders.retain(|folder| *folder != self.0);
        // A hidden folder that cannot be removed does no harm.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Attempts to remove a temporary folder that another thread may still be writing.
const TRIES: usize = 100;

/// Removes all temporary folders and prevents new ones. Called when a signal is about to end the program.
pub fn close_workshops() {
    let folders = {
        let mut open = open();
        open.closed = true;
        std::mem::take(&mut open.folders)
    };
    for folder in folders {
        // A file created while the folder is being removed makes the removal fail; try again.
        let _ = (0..TRIES).find(|_| std::fs::remove_dir_all(&folder).is_ok() || !folder.exists());
    }
}
