//! What the lines of a trajectory are written to.

use std::fs::{File, Metadata};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

/// Where lines end up: a file, or in tests one that forgets what was not synced.
pub(in crate::session) trait Medium: Send {
    /// Appends bytes.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Makes everything appended survive a power cut.
    fn sync(&self) -> io::Result<()>;
    /// Forgets everything after so many bytes.
    fn cut(&mut self, length: u64) -> io::Result<()>;
    /// Whether it is still the one that stands at a path, as long as it was left.
    fn is_ours(&self, path: &Path, length: u64) -> bool;
}

impl Medium for File {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.write_all(bytes)
    }

    fn sync(&self) -> io::Result<()> {
        self.sync_data()
    }

    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::Start(length)).map(|_| ())
    }

    fn is_ours(&self, path: &Path, length: u64) -> bool {
        let (Ok(own), Ok(there)) = (self.metadata(), std::fs::metadata(path)) else { return false };
        own.len() == length && is_same(&own, &there)
    }
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
