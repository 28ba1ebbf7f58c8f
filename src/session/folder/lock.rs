//! The lock of a run: one program at a time writes it.

use std::fs::{File, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::Path;

use crate::session::error::RunError;

/// Whether a program plays the run at this moment.
pub fn is_being_played(folder: &Path) -> bool {
    let file = File::open(folder.join("lock"));
    file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// File in the folder of a run that says where programs reach it.
pub const SERVER_FILE: &str = "server.json";

/// Whether a server plays the run for a program at this moment; one that was killed leaves only its file.
pub(in crate::session) fn is_served(folder: &Path) -> bool {
    folder.join(SERVER_FILE).exists() && is_being_played(folder)
}

/// Claims a run for writing; the claim ends with the program, however it ends.
pub(in crate::session) fn lock_run(folder: &Path, id: &str) -> Result<File, RunError> {
    let path = folder.join("lock");
    let open = File::options().create(true).truncate(false).read(true).write(true).open(&path);
    let mut file = open.map_err(|error| match error.kind() {
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            RunError::NotWritable { id: id.to_owned(), folder: folder.to_owned(), error }
        }
        _ => RunError::Io { path: path.clone(), error },
    })?;
    match file.try_lock() {
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
