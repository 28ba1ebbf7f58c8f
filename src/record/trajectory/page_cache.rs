//! A file for tests whose page cache behaves as a kernel's does: a failed sync marks pages clean that were not written, and the
//! next sync succeeds.

use std::io;
use std::ops::Range;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard};

use super::medium::Medium;

/// The file; clones are the same one.
#[derive(Clone)]
pub struct PageCache(Arc<Mutex<CachedBytes>>);

#[derive(Default)]
struct CachedBytes {
    /// What a power cut leaves.
    disk: Vec<u8>,
    /// What programs read.
    cache: Vec<u8>,
    /// Bytes of the cache that the next successful sync writes.
    dirty: Vec<Range<usize>>,
    /// Syncs that fail from now on.
    failing_syncs: u32,
    /// Whether there is no room for more bytes.
    is_full: bool,
}

impl PageCache {
    /// A file that holds synced bytes.
    pub fn holding(bytes: Vec<u8>) -> PageCache {
        PageCache(Arc::new(Mutex::new(CachedBytes {
            disk: bytes.clone(),
            cache: bytes,
            ..CachedBytes::default()
        })))
    }

    /// Lets the next syncs fail.
    pub fn fail_syncs(&self, count: u32) {
        self.pages().failing_syncs = count;
    }

    /// Refuses appended bytes from now on, or no longer.
    pub fn set_full(&self, is_full: bool) {
        self.pages().is_full = is_full;
    }

    /// What a power cut leaves of the file.
    pub fn after_a_power_cut(&self) -> Vec<u8> {
        self.pages().disk.clone()
    }

    /// What is left of the file if only the program is killed.
    pub fn after_a_kill(&self) -> Vec<u8> {
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

    fn cut(&mut self, length: u64) -> io::Result<()> {
        let pages = &mut *self.pages();
        let length = length as usize;
        pages.cache.truncate(length);
        for range in &mut pages.dirty {
            *range = range.start.min(length)..range.end.min(length);
        }
        Ok(())
    }

    fn is_ours(&self, _path: &Path, length: Option<u64>) -> bool {
        length.is_none_or(|length| length == self.pages().cache.len() as u64)
    }

    fn beginning(&mut self, length: u64) -> io::Result<Vec<u8>> {
        Ok(self.pages().cache[..length as usize].to_vec())
    }
}
