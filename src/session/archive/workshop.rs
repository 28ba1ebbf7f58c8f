//! A folder to work in, that is gone afterwards.

use std::path::{Path, PathBuf};

use crate::session::create::new_id;
use crate::session::error::RunError;

/// A folder of its own beside what is being made. It is hidden, holds nothing that is listed as a run, and is removed
/// when the work is done or has failed.
pub(super) struct Workshop(PathBuf);

impl Workshop {
    /// Makes one in a folder.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn within(folder: &Path) -> Result<Workshop, RunError> {
        std::fs::create_dir_all(folder).map_err(RunError::io(folder))?;
        let own = folder.join(format!(".novamind-{}", new_id()));
        std::fs::create_dir(&own).map_err(RunError::io(&own))?;
        Ok(Workshop(own))
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Workshop {
    fn drop(&mut self) {
        // What cannot be removed is only in the way of whoever looks for hidden folders.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
