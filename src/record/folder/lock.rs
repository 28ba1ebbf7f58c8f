//! The lock of a run, which lets only one program at a time write the run.

use std::fs::{File, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

use crate::error::RunError;

/// Returns whether a program has the run open for play.
pub fn is_locked(folder: &Path) -> bool {
    let file = File::open(folder.join("lock"));
    file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// File in the run folder that contains the address of the server of the run.
pub const SERVER_FILE: &str = "server.json";

/// Returns whether a server has the run open. A killed server leaves its server file but not its lock.
pub fn is_served(folder: &Path) -> bool {
    folder.join(SERVER_FILE).exists() && is_locked(folder)
}

/// The lock of a run, which is released on drop. If the process ends first, the operating system releases the lock.
///
/// Closing the file is not enough: a new child process has a copy of the open file until the child starts its program,
/// and a file stays locked until all copies are closed.
#[derive(Debug)]
pub struct RunLock(File);

impl Drop for RunLock {
    fn drop(&mut self) {
        // If unlocking fails, closing the file releases the lock.
        let _ = self.0.unlock();
    }
}

/// Locks a run for writing.
///
/// # Errors
/// Another program has locked the run, or the lock file cannot be opened.
pub fn lock_run(folder: &Path, id: &str) -> Result<RunLock, RunError> {
    let path = folder.join("lock");
    let open = File::options().create(true).truncate(false).read(true).write(true).open(&path);
    let mut file = open.map_err(|error| match error.kind() {
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            RunError::NotWritable { id: id.to_owned(), folder: folder.to_owned(), error }
        }
        _ => RunError::Io { path: path.clone(), error },
    })?;
    match lock_with_retries(&file) {
        Ok(()) => {
            // The process id is for information only; the file lock prevents a second writer.
            let _ = file.set_len(0).and_then(|()| writeln!(file, "process {}", std::process::id()));
            Ok(RunLock(file))
        }
        Err(TryLockError::WouldBlock) => {
            let holder = std::fs::read_to_string(&path).unwrap_or_default().trim().to_owned();
            Err(RunError::InUse { id: id.to_owned(), holder })
        }
        Err(TryLockError::Error(error)) => Err(RunError::Io { path, error }),
    }
}

/// Maximum number of lock attempts, 2 ms apart, while other programs have only shared locks.
const MAX_LOCK_ATTEMPTS: u32 = 500;

/// Acquires the exclusive lock. Waits for the brief shared locks of [`is_locked`], but fails at once if a program that
/// plays the run has the exclusive lock.
fn lock_with_retries(file: &File) -> Result<(), TryLockError> {
    for _ in 0..MAX_LOCK_ATTEMPTS {
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

    /// Stops the probing threads, even if an assertion fails.
    struct StopProbes<'a>(&'a AtomicBool);

    impl Drop for StopProbes<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }

    #[test]
    fn dropped_lock_is_free_although_a_child_process_has_a_copy_of_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let lock = lock_run(folder.path(), "0123abcd").expect("free");
        let _copy = lock.0.try_clone().expect("a copy");
        drop(lock);
        assert!(lock_run(folder.path(), "0123abcd").is_ok());
    }

    #[test]
    fn lock_run_waits_for_probes_and_fails_while_locked() {
        let folder = tempfile::tempdir().expect("a folder");
        drop(lock_run(folder.path(), "0123abcd").expect("free"));
        let is_over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let _end = StopProbes(&is_over);
            for _ in 0..3 {
                scope.spawn(|| {
                    while !is_over.load(Ordering::Relaxed) {
                        is_locked(folder.path());
                    }
                });
            }
            for attempt in 0..300 {
                let lock = lock_run(folder.path(), "0123abcd")
                    .unwrap_or_else(|error| panic!("attempt {attempt}: {error}"));
                assert!(is_locked(folder.path()), "attempt {attempt}");
                let second = lock_run(folder.path(), "0123abcd");
                assert!(matches!(second, Err(RunError::InUse { .. })), "attempt {attempt}: {second:?}");
                drop(lock);
            }
        });
        assert!(!is_locked(folder.path()));
    }
}
