//! The folder that a script works in: new, empty, gone afterwards.

use std::fs::DirBuilder;
use std::io::ErrorKind;
use std::os::unix::fs::DirBuilderExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A folder of its own for as long as this lives.
#[derive(Debug)]
pub(super) struct EmptyFolder(PathBuf);

impl EmptyFolder {
    /// Makes one among the temporary files.
    ///
    /// # Errors
    /// It cannot be made there.
    pub fn create() -> std::io::Result<EmptyFolder> {
        static MADE: AtomicU32 = AtomicU32::new(0);
        loop {
            let number = MADE.fetch_add(1, Ordering::Relaxed);
            let name = format!("novamind-script-{}-{number}", std::process::id());
            let path = std::env::temp_dir().join(name);
            match DirBuilder::new().mode(0o700).create(&path) {
                Ok(()) => return Ok(EmptyFolder(path)),
                // A program that was killed left it.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for EmptyFolder {
    fn drop(&mut self) {
        // What cannot be removed is an empty folder among temporary files.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
