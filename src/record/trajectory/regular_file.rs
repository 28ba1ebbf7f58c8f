//! Opening what somebody else may have put in the place of a file: a pipe would keep the program waiting for ever.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

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
pub(super) fn write_to_regular_file(path: &Path) -> io::Result<File> {
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
