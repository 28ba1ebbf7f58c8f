//! The folder that a script works in: new, empty, gone afterwards.

use std::fs::DirBuilder;
use std::io::ErrorKind;
use std::os::unix::fs::DirBuilderExt;
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// What the folders begin with.
const NAME: &str = "novamind-script-";

/// No script lives nearly as long: a folder that was not touched since was left by a program that was killed.
const LEFT_BEHIND: Duration = Duration::from_secs(60 * 60);

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
        static SWEPT: Once = Once::new();
        let place = std::env::temp_dir();
        SWEPT.call_once(|| sweep(&place, LEFT_BEHIND));
        loop {
            let number = MADE.fetch_add(1, Ordering::Relaxed);
            let path = place.join(format!("{NAME}{}-{number}", std::process::id()));
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

/// Removes what killed programs have left; what belongs to somebody else cannot be removed, and stays.
fn sweep(place: &Path, left_behind: Duration) {
    for entry in std::fs::read_dir(place).into_iter().flatten().flatten() {
        let is_ours = entry.file_name().to_string_lossy().starts_with(NAME);
        let touched =
            entry.metadata().ok().filter(|own| is_ours && own.is_dir()).and_then(|own| own.modified().ok());
        if touched.and_then(|at| at.elapsed().ok()).is_some_and(|age| age > left_behind) {
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
}

impl Drop for EmptyFolder {
    fn drop(&mut self) {
        // What cannot be removed is an empty folder among temporary files.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_killed_programs_left_goes_and_nothing_else() {
        let place = tempfile::tempdir().expect("a folder");
        for name in ["novamind-script-1-0", "novamind-script-2-0/inside", "other", "novamind-scripts"] {
            std::fs::create_dir_all(place.path().join(name)).expect("a folder");
        }
        std::fs::write(place.path().join("novamind-script-3-0"), "a file").expect("a file");
        sweep(place.path(), LEFT_BEHIND);
        assert_eq!(std::fs::read_dir(place.path()).expect("a folder").count(), 5, "they are young");
        std::thread::sleep(Duration::from_millis(5));
        sweep(place.path(), Duration::ZERO);
        let names = std::fs::read_dir(place.path()).expect("a folder").flatten();
        let mut left: Vec<String> = names.map(|own| own.file_name().to_string_lossy().into_owned()).collect();
        left.sort_unstable();
        assert_eq!(left, ["novamind-script-3-0", "novamind-scripts", "other"]);
    }
}
