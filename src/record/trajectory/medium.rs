//! The storage to which a trajectory is written.

use std::fs::{File, Metadata};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Storage of lines: a file, or in tests a file with a simulated page cache.
pub trait Medium: Send {
    /// Appends bytes at the end of the storage.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Syncs the appended bytes to the disk. After an error, bytes since the last successful sync may be lost even if
    /// a later sync succeeds, because the kernel may have marked the pages clean.
    fn sync(&self) -> io::Result<()>;
    /// Truncates the storage to a length in bytes.
    fn truncate(&mut self, length: u64) -> io::Result<()>;
    /// Returns whether `path` still names the open file and, if `length` is given, whether the file has that length.
    fn is_file_at(&self, path: &Path, length: Option<u64>) -> bool;
    /// Returns the first `length` bytes, even if the file was moved.
    fn read_prefix(&mut self, length: u64) -> io::Result<Vec<u8>>;
}

/// An open file, and the number of its hard links when it was opened.
pub(super) struct NamedFile {
    file: File,
    link_count: u64,
}

impl NamedFile {
    pub(super) fn from_open_file(file: File) -> io::Result<NamedFile> {
        let names = count_links(&file.metadata()?);
        Ok(NamedFile { file, link_count: names })
    }
}

impl Medium for NamedFile {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)
    }

    fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    fn truncate(&mut self, length: u64) -> io::Result<()> {
        self.file.set_len(length)?;
        self.file.seek(SeekFrom::Start(length)).map(|_| ())
    }

    fn is_file_at(&self, path: &Path, length: Option<u64>) -> bool {
        let (Ok(opened), Ok(there)) = (self.file.metadata(), std::fs::metadata(path)) else { return false };
        length.is_none_or(|length| opened.len() == length)
            && is_same_file(&opened, &there)
            && count_links(&opened) == self.link_count
    }

    fn read_prefix(&mut self, length: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.file.seek(SeekFrom::Start(0))?;
        let read = (&mut self.file).take(length).read_to_end(&mut bytes);
        self.file.seek(SeekFrom::End(0))?;
        read.map(|_| bytes)
    }
}

/// Returns the number of hard links. Through a new link, another program could change the file.
#[cfg(unix)]
fn count_links(file: &Metadata) -> u64 {
    use std::os::unix::fs::MetadataExt;
    file.nlink()
}

#[cfg(not(unix))]
fn count_links(_file: &Metadata) -> u64 {
    1
}

#[cfg(unix)]
fn is_same_file(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// Compares only lengths: on systems other than Unix, an open file can be neither moved nor removed.
#[cfg(not(unix))]
fn is_same_file(one: &Metadata, other: &Metadata) -> bool {
    one.len() == other.len()
}
