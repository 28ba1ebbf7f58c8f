//! A test file that simulates the page cache of a kernel: a failed sync marks unwritten pages clean, and the next sync
//! succeeds.

use std::io;
use std::ops::Range;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard};

use super::medium::Medium;

/// A test file in memory; clones share its content.
#[derive(Clone)]
pub struct PageCache(Arc<Mutex<CachedBytes>>);

#[derive(Default)]
struct CachedBytes {
    /// Content of the disk, which survives a power cut.
    disk: Vec<u8>,
    /// Content of the page cache, which programs read.
    cache: Vec<u8>,
    /// Ranges of the cache that the next successful sync writes to the disk.
    dirty: Vec<Range<usize>>,
    /// Number of upcoming syncs that fail.
    failing_syncs: u32,
    is_full: bool,
}

impl PageCache {
    /// Returns a file whose content is already synced.
    pub fn with_synced_bytes(bytes: Vec<u8>) -> PageCache {
        PageCache(Arc::new(Mutex::new(CachedBytes {
            disk: bytes.clone(),
            cache: bytes,
            ..CachedBytes::default()
        })))
    }

    /// Makes the next `count` syncs fail.
    pub fn fail_next_syncs(&self, count: u32) {
        self.pages().failing_syncs = count;
    }

    /// Sets whether appending fails as if the disk were full.
    pub fn set_full(&self, is_full: bool) {
        self.pages().is_full = is_full;
    }

    /// Returns the content of the file after a power cut.
    pub fn bytes_after_power_cut(&self) -> Vec<u8> {
        self.pages().disk.clone()
    }

    /// Returns the content of the file after the program is killed without a power cut.
    pub fn bytes_after_kill(&self) -> Vec<u8> {
        self.pages().cache.clone()
    }

    fn pages(&self) -> MutexGuard<'_, CachedBytes> {
        self.0.lock().expect("a lock")
    }
}

impl Medium for PageCache {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut pages = self.pages();
        if pages.is_full && !bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let from = pages.cache.len();
        pages.cache.extend_from_slice(bytes);
        pages.dirty.push(from..from + bytes.len());
        Ok(())
    }

    fn sync(&self) -> io::Result<()> {
        let pages = &mut *self.pages();
        if pages.failing_syncs > 0 {
            pages.failing_syncs -= 1;
            pages.dirty.clear();
            return Err(io::Error::other("the disk did not accept the pages"));
        }
        pages.disk.resize(pages.cache.len(), 0);
        for range in pages.dirty.drain(..) {
            pages.disk[range.clone()].copy_from_slice(&pages.cache[range]);
        }
        Ok(())
    }

    fn truncate(&mut self, length: u64) -> io::Result<()> {
        let pages = &mut *self.pages();
        let length = length as usize;
        pages.cache.truncate(length);
        for range in &mut pages.dirty {
            *range = range.start.min(length)..range.end.min(length);
        }
        Ok(())
    }

    fn is_file_at(&self, _path: &Path, length: Option<u64>) -> bool {
        length.is_none_or(|length| length == self.pages().cache.len() as u64)
    }

    fn read_prefix(&mut self, length: u64) -> io::Result<Vec<u8>> {
        Ok(self.pages().cache[..length as usize].to_vec())
    }
}
