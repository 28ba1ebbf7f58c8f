//! The temporary working folder of a Python script.

use std::fs::DirBuilder;
use std::io::ErrorKind;
use std::os::unix::fs::DirBuilderExt;
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

const NAME_PREFIX: &str = "novamind-script-";

/// Age after which a script folder is stale: no script runs this long, so a killed program must have left the folder.
const STALE_AFTER: Duration = Duration::from_secs(60 * 60);

/// A new temporary folder, which is removed on drop.
#[derive(Debug)]
pub(super) struct ScriptFolder(PathBuf);

impl ScriptFolder {
    /// Creates a script folder in the system's temporary folder.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn create() -> std::io::Result<ScriptFolder> {
        static CREATED: AtomicU32 = AtomicU32::new(0);
        static SWEPT: Once = Once::new();
        let place = std::env::temp_dir();
        SWEPT.call_once(|| remove_stale_folders(&place, STALE_AFTER));
        loop {
            let number = CREATED.fetch_add(1, Ordering::Relaxed);
            let path = place.join(format!("{NAME_PREFIX}{}-{number}", std::process::id()));
            match DirBuilder::new().mode(0o700).create(&path) {
                Ok(()) => return Ok(ScriptFolder(path)),
                // A killed program with the same process id left this folder; try the next number.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

/// Removes script folders that killed programs left, if the permissions allow it.
fn remove_stale_folders(place: &Path, left_behind: Duration) {
    for entry in std::fs::read_dir(place).into_iter().flatten().flatten() {
        let is_ours = entry.file_name().to_string_lossy().starts_with(NAME_PREFIX);
        let touched = entry
            .metadata()
            .ok()
            .filter(|metadata| is_ours && metadata.is_dir())
            .and_then(|metadata| metadata.modified().ok());
        if touched.and_then(|at| at.elapsed().ok()).is_some_and(|age| age > left_behind) {
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
}

impl Drop for ScriptFolder {
    fn drop(&mut self) {
        // Ignore the error: a remaining temporary folder is harmless.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remove_stale_folders_removes_only_old_script_folders() {
        let place = tempfile::tempdir().expect("a folder");
        for name in ["novamind-script-1-0", "novamind-script-2-0/inside", "other", "novamind-scripts"] {
            std::fs::create_dir_all(place.path().join(name)).expect("a folder");
        }
        std::fs::write(place.path().join("novamind-script-3-0"), "a file").expect("a file");
        remove_stale_folders(place.path(), STALE_AFTER);
        assert_eq!(std::fs::read_dir(place.path()).expect("a folder").count(), 5, "new folders are kept");
        std::thread::sleep(Duration::from_millis(5));
        remove_stale_folders(place.path(), Duration::ZERO);
        let names = std::fs::read_dir(place.path()).expect("a folder").flatten();
        let mut left: Vec<String> =
            names.map(|dir_entry| dir_entry.file_name().to_string_lossy().into_owned()).collect();
        left.sort_unstable();
        assert_eq!(left, ["novamind-script-3-0", "novamind-scripts", "other"]);
    }
}
