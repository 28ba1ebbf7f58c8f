//! File operations whose results survive a power cut. A file is safe only after its content and its directory
//! entry are synced.
//!
//! The `open_regular_file` functions reject pipes and devices, because opening a pipe would block the program.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::Path;

use crate::error::RunError;

/// Replaces a file atomically. After a crash, the file has either the old or the new content.
///
/// # Errors
/// The file cannot be written. The old file is kept, unless only the folder sync failed.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    replace_with_draft(path, bytes, |draft| File::create(draft))
}

/// Replaces a file atomically like [`write_atomically`]. On Unix, only the file's owner can read the file.
///
/// # Errors
/// Same as [`write_atomically`].
pub fn write_private_atomically(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    replace_with_draft(path, bytes, |draft| {
        // The draft of a crashed process can have other permissions.
        let _ = std::fs::remove_file(draft);
        create_private_file(draft)
    })
}

/// Creates a file. On Unix, only its owner can read the file.
///
/// # Errors
/// The file exists or cannot be created.
pub fn create_private_file(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path)
}

/// Reads a file. Returns `None` if the file does not exist.
///
/// # Errors
/// The file exists but cannot be read.
pub fn read_if_exists(path: &Path) -> Result<Option<Vec<u8>>, RunError> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(RunError::io(path)(error)),
    }
}

fn replace_with_draft(
    path: &Path,
    bytes: &[u8],
    create: impl FnOnce(&Path) -> io::Result<File>,
) -> Result<(), RunError> {
    let draft = path.with_extension("draft");
    let written = create(&draft)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| std::fs::rename(&draft, path));
    if let Err(error) = written {
        let _ = std::fs::remove_file(&draft);
        return Err(RunError::io(path)(error));
    }
    sync_folder(parent_folder(path))
}

/// Appends bytes to a regular file and syncs the file. Also syncs the folder if the file is new.
///
/// # Errors
/// The path is not a regular file, or the file cannot be written.
pub fn append_synced(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    let is_new = !path.exists();
    let mut file = open_regular_file_for_append(path).map_err(RunError::io(path))?;
    file.write_all(bytes).and_then(|()| file.sync_all()).map_err(RunError::io(path))?;
    if is_new { sync_folder(parent_folder(path)) } else { Ok(()) }
}

/// Creates a folder and its missing ancestors, and syncs the parent of each new folder.
///
/// # Errors
/// A folder cannot be created or synced. New folders are removed, so that the next attempt creates and syncs them.
pub fn create_folder(folder: &Path) -> Result<(), RunError> {
    let missing: Vec<&Path> =
        folder.ancestors().take_while(|path| !path.as_os_str().is_empty() && !path.exists()).collect();
    std::fs::create_dir_all(folder).map_err(RunError::io(folder))?;
    let synced = missing.iter().rev().try_for_each(|ancestor| sync_folder(parent_folder(ancestor)));
    synced.inspect_err(|_| missing.iter().for_each(|ancestor| drop(std::fs::remove_dir(ancestor))))
}

/// Returns the parent folder of a file. The parent folder of a bare file name is the current directory.
pub fn parent_folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Syncs the directory entries of a folder, on systems that support this operation. After an error, the caller must
/// create the directory entry again: a later successful sync does not cover the entry.
///
/// # Errors
/// The folder cannot be synced.
pub fn sync_folder(folder: &Path) -> Result<(), RunError> {
    #[cfg(any(test, feature = "test-kit"))]
    sync_probe::record_sync(folder).map_err(RunError::io(folder))?;
    if cfg!(unix) {
        File::open(folder).and_then(|folder| folder.sync_all()).map_err(RunError::io(folder))?;
    }
    Ok(())
}

/// Opens a regular file for reading.
///
/// # Errors
/// The file does not exist, is not a regular file, or cannot be opened.
pub fn open_regular_file(path: &Path) -> io::Result<File> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(not_regular_file_error());
    }
    File::open(path)
}

/// Opens a regular file for appending and reading, and creates the file if it does not exist.
///
/// # Errors
/// The path is not a regular file, or it cannot be opened or created.
pub fn open_regular_file_for_append(path: &Path) -> io::Result<File> {
    if std::fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
        return Err(not_regular_file_error());
    }
    File::options().create(true).read(true).append(true).open(path)
}

/// Opens a regular file for reading and writing.
///
/// # Errors
/// The file does not exist, is not a regular file, or cannot be opened.
pub(crate) fn open_regular_file_for_write(path: &Path) -> io::Result<File> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(not_regular_file_error());
    }
    File::options().read(true).write(true).open(path)
}

fn not_regular_file_error() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, "not a regular file")
}

/// Reads a regular file and returns its bytes.
///
/// # Errors
/// [`open_regular_file`] fails, or the file cannot be read.
pub fn read_regular_file(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_regular_file(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a regular file and returns its text, or an empty text if the file cannot be read.
pub fn read_regular_text_or_empty(path: &Path) -> String {
    read_regular_file(path).ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
}

/// Test support that records the folder syncs of each thread and can make them fail.
#[cfg(any(test, feature = "test-kit"))]
pub mod sync_probe {
    use std::cell::{Cell, RefCell};
    use std::io;
    use std::path::{Path, PathBuf};

    thread_local! {
        static SYNCED_ENTRIES: RefCell<Vec<(PathBuf, Vec<String>)>> = const { RefCell::new(Vec::new()) };
        static SYNC_FAILS: Cell<bool> = const { Cell::new(false) };
    }

    pub(super) fn record_sync(folder: &Path) -> io::Result<()> {
        if SYNC_FAILS.get() {
            return Err(io::Error::other("the folder cannot be synced"));
        }
        let mut names: Vec<String> = std::fs::read_dir(folder)?
            .flatten()
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        SYNCED_ENTRIES.with_borrow_mut(|synced| synced.push((folder.to_owned(), names)));
        Ok(())
    }

    /// Returns whether this thread synced the directory entry of a path after creating the path.
    pub fn has_synced(path: &Path) -> bool {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let folder = super::parent_folder(path);
        SYNCED_ENTRIES.with_borrow(|synced| {
            synced.iter().any(|(parent, names)| parent == folder && names.contains(&name))
        })
    }

    /// Clears the recorded syncs of this thread. Later syncs fail if `fails` is true.
    pub fn reset(fails: bool) {
        SYNCED_ENTRIES.with_borrow_mut(Vec::clear);
        SYNC_FAILS.set(fails);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn create_folder_syncs_each_new_parent_entry() {
        let place = tempfile::tempdir().expect("a folder");
        let (one, two) = (place.path().join("one"), place.path().join("one/two"));
        create_folder(&two).expect("created");
        assert!(sync_probe::has_synced(&one) && sync_probe::has_synced(&two));
        sync_probe::reset(false);
        create_folder(&two).expect("it exists");
        assert!(!sync_probe::has_synced(&two), "no new folder");
        sync_probe::reset(true);
        assert!(create_folder(&two.join("three/four")).is_err());
        sync_probe::reset(false);
        assert!(!two.join("three").exists() && two.exists());
    }

    #[test]
    fn append_synced_syncs_the_folder_of_new_files() {
        let place = tempfile::tempdir().expect("a folder");
        let path = place.path().join("lines");
        append_synced(&path, b"one\n").expect("written");
        assert!(sync_probe::has_synced(&path));
        append_synced(&path, b"two\n").expect("written");
        assert_eq!(std::fs::read(&path).expect("bytes"), b"one\ntwo\n");
        assert!(append_synced(place.path(), b"a folder is not a file").is_err());
    }
}
