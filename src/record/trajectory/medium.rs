//! What the lines of a trajectory are written to.

use std::fs::{File, Metadata};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Where lines end up: a file, or in tests one with a page cache that can fail.
pub trait Medium: Send {
    /// Appends bytes.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Makes everything appended survive a power cut. After an error, whatever was appended since the last successful sync
    /// may be lost, and a later success proves nothing about it: the kernel may have marked the pages clean.
    fn sync(&self) -> io::Result<()>;
    /// Forgets everything after so many bytes.
    fn cut(&mut self, length: u64) -> io::Result<()>;
    /// Whether it is still the file at a path, with the length at which it was left, if that is known.
    fn is_ours(&self, path: &Path, length: Option<u64>) -> bool;
    /// What its first bytes are, wherever it has gone.
    fn beginning(&mut self, length: u64) -> io::Result<Vec<u8>>;
}

/// A file, and how many names it had when it was opened.
pub(super) struct NamedFile {
    file: File,
    names: u64,
}

impl NamedFile {
    /// An open file, for reading and writing.
    pub(super) fn of(file: File) -> io::Result<NamedFile> {
        let names = names_of(&file.metadata()?);
        Ok(NamedFile { file, names })
    }
}

impl Medium for NamedFile {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)
    }

    fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.file.set_len(length)?;
        self.file.seek(SeekFrom::Start(length)).map(|_| ())
    }

    fn is_ours(&self, path: &Path, length: Option<u64>) -> bool {
        let (Ok(own), Ok(there)) = (self.file.metadata(), std::fs::metadata(path)) else { return false };
        length.is_none_or(|length| own.len() == length)
            && is_same(&own, &there)
            && names_of(&own) == self.names
    }

    fn beginning(&mut self, length: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.file.seek(SeekFrom::Start(0))?;
        let read = (&mut self.file).take(length).read_to_end(&mut bytes);
        self.file.seek(SeekFrom::End(0))?;
        read.map(|_| bytes)
    }
}

/// Hard links of a file: another one is another way to change it.
#[cfg(unix)]
fn names_of(file: &Metadata) -> u64 {
    use std::os::unix::fs::MetadataExt;
    file.nlink()
}

#[cfg(not(unix))]
fn names_of(_file: &Metadata) -> u64 {
    1
}

#[cfg(unix)]
fn is_same(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// Elsewhere a file that is open can neither be moved nor removed.
#[cfg(not(unix))]
fn is_same(one: &Metadata, other: &Metadata) -> bool {
    one.len() == other.len()
}
