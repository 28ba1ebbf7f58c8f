//! A test file with a page cache like that of a kernel: a failed sync marks unwritten pages clean, and the next sync
//! succeeds.

use std::io;
use std::ops::Range;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard};

use super::medium::Medium;

/// The file; clones share it.
#[derive(Clone)]
pub struct PageCache(Arc<Mutex<CachedBytes>>);

#[derive(Default)]
struct CachedBytes {
    /// Bytes that survive a power cut.
    disk: Vec<u8>,
    /// Bytes that programs read.
    cache: Vec<u8>,
    /// Bytes of the cache that the next successful sync writes.
    dirty: Vec<Range<usize>>,
    /// Number of next syncs that fail.
    failing_syncs: u32,
    /// Whether the disk is full.
    is_full: bool,
}

impl PageCache {
    /// Returns a file with synced bytes.
    pub fn with_synced_bytes(bytes: Vec<u8>) -> PageCache {
        PageCache(Arc::new(Mutex::new(CachedBytes {
            disk: bytes.clone(),
            cache: bytes,
            ..CachedBytes::default()
        })))
    }

    /// Lets the next `count` syncs fail.
    pub fn fail_next_syncs(&self, count: u32) {
        self.pages().failing_syncs = count;
    }

    /// Sets whether appending fails because the disk is full.
    pub fn set_full(&self, is_full: bool) {
        self.pages().is_full = is_full;
    }

    /// Returns the bytes that survive a power cut.
    pub fn bytes_after_power_cut(&self) -> Vec<u8> {
        self.pages().disk.clone()
    }

    /// Returns the bytes that survive if only the program is killed.
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
            return Err(io::Error::other("the disk did not take the pages"));
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
