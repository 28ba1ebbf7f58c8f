//! The lock of a run: one program at a time writes it.

use std::fs::{File, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

use crate::error::RunError;

/// Whether a program plays the run at this moment.
pub fn is_being_played(folder: &Path) -> bool {
    let file = File::open(folder.join("lock"));
    file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// File in the folder of a run that says where programs reach it.
pub const SERVER_FILE: &str = "server.json";

/// Whether a server plays the run for a program at this moment; one that was killed leaves only its file.
pub fn is_served(folder: &Path) -> bool {
    folder.join(SERVER_FILE).exists() && is_being_played(folder)
}

/// Claims a run for writing; the claim ends with the program, however it ends.
pub fn lock_run(folder: &Path, id: &str) -> Result<File, RunError> {
    let path = folder.join("lock");
    let open = File::options().create(true).truncate(false).read(true).write(true).open(&path);
    let mut file = open.map_err(|error| match error.kind() {
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            RunError::NotWritable { id: id.to_owned(), folder: folder.to_owned(), error }
        }
        _ => RunError::Io { path: path.clone(), error },
    })?;
    match lock_past_looks(&file) {
        Ok(()) => {
            // Only for people who look; the lock itself is what counts.
            let _ = file.set_len(0).and_then(|()| writeln!(file, "process {}", std::process::id()));
            Ok(file)
        }
        Err(TryLockError::WouldBlock) => {
            let holder = std::fs::read_to_string(&path).unwrap_or_default().trim().to_owned();
            Err(RunError::InUse { id: id.to_owned(), holder })
        }
        Err(TryLockError::Error(error)) => Err(RunError::Io { path, error }),
    }
}

/// Attempts to take a lock that only looks keep, 2 ms apart.
const ATTEMPTS: u32 = 500;

/// Takes a lock. A look ([`is_being_played`]) holds it for a moment, together with other looks: it is waited for. A program that
/// plays the run holds it alone: that one is not.
fn lock_past_looks(file: &File) -> Result<(), TryLockError> {
    for _ in 0..ATTEMPTS {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {}
            other => return other,
        }
        file.try_lock_shared()?;
        file.unlock().map_err(TryLockError::Error)?;
        sleep(Duration::from_millis(2));
    }
    file.try_lock()
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::*;

    /// Ends the looks, also when an assertion fails.
    struct EndLooks<'a>(&'a AtomicBool);

    impl Drop for EndLooks<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }

    #[test]
    fn lock_run_succeeds_while_others_look_and_fails_while_the_run_is_played() {
        let folder = tempfile::tempdir().expect("a folder");
        drop(lock_run(folder.path(), "0123abcd").expect("free"));
        let is_over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let _end = EndLooks(&is_over);
            for _ in 0..3 {
                scope.spawn(|| {
                    while !is_over.load(Ordering::Relaxed) {
                        is_being_played(folder.path());
                    }
                });
            }
            for attempt in 0..300 {
                let lock = lock_run(folder.path(), "0123abcd")
                    .unwrap_or_else(|error| panic!("attempt {attempt}: {error}"));
                assert!(is_being_played(folder.path()), "attempt {attempt}");
                let second = lock_run(folder.path(), "0123abcd");
                assert!(matches!(second, Err(RunError::InUse { .. })), "attempt {attempt}: {second:?}");
                drop(lock);
            }
        });
        assert!(!is_being_played(folder.path()));
    }
}
