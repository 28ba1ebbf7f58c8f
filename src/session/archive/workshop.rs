//! A folder to work in, that is gone afterwards.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use crate::recording::folders::new_id;
use novamind_record::error::RunError;
use novamind_record::files::create_folder;

/// A folder of its own beside what is being made. It is hidden, holds nothing that is listed as a run, and is removed
/// when the work is done or has failed.
pub struct Workshop(PathBuf);

/// The workshops that are open, and whether the program is about to end.
struct Open {
    folders: Vec<PathBuf>,
    closed: bool,
}

static OPEN: Mutex<Open> = Mutex::new(Open { folders: Vec::new(), closed: false });

fn open() -> MutexGuard<'static, Open> {
    OPEN.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

impl Workshop {
    /// Makes one in a folder.
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

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Workshop {
    fn drop(&mut self) {
        open().folders.retain(|folder| *folder != self.0);
        // What cannot be removed is only in the way of whoever looks for hidden folders.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Tries to remove a workshop that somebody may still be writing into.
const TRIES: usize = 100;

/// Removes every open workshop and makes no new ones: for a program that a signal is about to end.
pub fn close_workshops() {
    let folders = {
        let mut open = open();
        open.closed = true;
        std::mem::take(&mut open.folders)
    };
    for folder in folders {
        // A file that is made between the look into the folder and its removal asks for another look.
        let _ = (0..TRIES).find(|_| std::fs::remove_dir_all(&folder).is_ok() || !folder.exists());
    }
}
