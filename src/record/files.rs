//! Files and folders that survive a power cut: a file is on the disk only when its directory entry is, too.
//!
//! Regular files are opened by functions of their own: a pipe in the place of a file would block the program.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use crate::error::RunError;

/// Writes a file so that after a crash it is the old one or the new one, never a part of it.
///
/// # Errors
/// The disk refuses it. The old file is kept, unless only the sync of the folder failed.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    let draft = path.with_extension("draft");
    let written = File::create(&draft)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| std::fs::rename(&draft, path));
    if let Err(error) = written {
        let _ = std::fs::remove_file(&draft);
        return Err(RunError::io(path)(error));
    }
    sync_folder(folder_of(path))
}

/// Appends bytes to a regular file and syncs it, and its folder if the file is new.
///
/// # Errors
/// The path is not a regular file, or the disk refuses.
pub fn append_synced(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    let is_new = !path.exists();
    let mut file = append_to_regular_file(path).map_err(RunError::io(path))?;
    file.write_all(bytes).and_then(|()| file.sync_all()).map_err(RunError::io(path))?;
    if is_new { sync_folder(folder_of(path)) } else { Ok(()) }
}

/// Creates a folder and its missing ancestors, and syncs the folder above each new one.
///
/// # Errors
/// The disk refuses. The new folders are removed again, so that the next attempt creates and syncs them.
pub fn create_folder(folder: &Path) -> Result<(), RunError> {
    let missing: Vec<&Path> =
        folder.ancestors().take_while(|own| !own.as_os_str().is_empty() && !own.exists()).collect();
    std::fs::create_dir_all(folder).map_err(RunError::io(folder))?;
    let synced = missing.iter().rev().try_for_each(|own| sync_folder(folder_of(own)));
    synced.inspect_err(|_| missing.iter().for_each(|own| drop(std::fs::remove_dir(own))))
}

/// The folder in which a file is: for a name alone, the one in which the program was started.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes the names in a folder survive a power cut, where the system can do that. After an error the caller must create the
/// name again: a later sync proves nothing about it.
///
/// # Errors
/// The disk refuses.
pub fn sync_folder(folder: &Path) -> Result<(), RunError> {
    #[cfg(any(test, feature = "test-kit"))]
    probe::note(folder).map_err(RunError::io(folder))?;
    if cfg!(unix) {
        File::open(folder).and_then(|folder| folder.sync_all()).map_err(RunError::io(folder))?;
    }
    Ok(())
}

/// Opens a regular file for reading.
///
/// # Errors
/// There is none, it is something else, or it cannot be opened.
pub fn open_regular_file(path: &Path) -> io::Result<File> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(no_regular_file());
    }
    File::open(path)
}

/// Opens a regular file for appending and reading; makes it where there is none.
///
/// # Errors
/// It is something else, or cannot be opened or made.
pub fn append_to_regular_file(path: &Path) -> io::Result<File> {
    if std::fs::metadata(path).is_ok_and(|own| !own.is_file()) {
        return Err(no_regular_file());
    }
    File::options().create(true).read(true).append(true).open(path)
}

/// Opens a regular file for reading and writing.
///
/// # Errors
/// There is no such file, it is something else, or it cannot be opened.
pub(crate) fn write_to_regular_file(path: &Path) -> io::Result<File> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(no_regular_file());
    }
    File::options().read(true).write(true).open(path)
}

fn no_regular_file() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, "this is no regular file")
}

/// The bytes of a regular file.
///
/// # Errors
/// As [`open_regular_file`]; it cannot be read.
pub fn read_regular_file(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_regular_file(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The same as a text; empty where there is none, or none that can be read.
pub fn read_regular_text(path: &Path) -> String {
    read_regular_file(path).ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
}

/// What tests see of folder syncs of their thread, and how they let them fail.
#[cfg(any(test, feature = "test-kit"))]
pub mod probe {
    use std::cell::{Cell, RefCell};
    use std::io;
    use std::path::{Path, PathBuf};

    thread_local! {
        static SYNCED: RefCell<Vec<(PathBuf, Vec<String>)>> = const { RefCell::new(Vec::new()) };
        static FAILS: Cell<bool> = const { Cell::new(false) };
    }

    pub(super) fn note(folder: &Path) -> io::Result<()> {
        if FAILS.get() {
            return Err(io::Error::other("the folder cannot be synced"));
        }
        let mut names: Vec<String> = std::fs::read_dir(folder)?
            .flatten()
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        SYNCED.with_borrow_mut(|synced| synced.push((folder.to_owned(), names)));
        Ok(())
    }

    /// Whether this thread has synced a directory entry after it was created.
    pub fn has_synced(path: &Path) -> bool {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let folder = super::folder_of(path);
        SYNCED.with_borrow(|synced| synced.iter().any(|(own, names)| own == folder && names.contains(&name)))
    }

    /// Forgets the syncs of this thread, and lets those to come fail or succeed.
    pub fn reset(fails: bool) {
        SYNCED.with_borrow_mut(Vec::clear);
        FAILS.set(fails);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn create_folder_syncs_the_folder_above_each_new_one() {
        let place = tempfile::tempdir().expect("a folder");
        let (one, two) = (place.path().join("one"), place.path().join("one/two"));
        create_folder(&two).expect("created");
        assert!(probe::has_synced(&one) && probe::has_synced(&two));
        probe::reset(false);
        create_folder(&two).expect("it is there");
        assert!(!probe::has_synced(&two), "nothing is new");
        probe::reset(true);
        assert!(create_folder(&two.join("three/four")).is_err());
        probe::reset(false);
        assert!(!two.join("three").exists() && two.exists());
    }

    #[test]
    fn append_synced_syncs_the_folder_of_a_new_file() {
        let place = tempfile::tempdir().expect("a folder");
        let path = place.path().join("lines");
        append_synced(&path, b"one\n").expect("written");
        assert!(probe::has_synced(&path));
        append_synced(&path, b"two\n").expect("written");
        assert_eq!(std::fs::read(&path).expect("bytes"), b"one\ntwo\n");
        assert!(append_synced(place.path(), b"a folder is not a file").is_err());
    }
}
