//! A file that is appended to, and what of it survives a power cut.
//!
//! After a failed sync the kernel may mark pages clean that it never wrote. A later sync then succeeds and proves nothing about
//! them. So bytes are kept in memory until a sync has succeeded, and are written again after one that failed.

use std::io;
use std::path::Path;

use super::medium::Medium;
use super::writer::Durability;

/// A file: `synced` bytes that survive a power cut, then `unsynced`.
pub(super) struct SyncedFile {
    medium: Box<dyn Medium>,
    /// Bytes at the beginning of the file that a successful sync covers.
    synced: u64,
    /// Accepted bytes of the file after them.
    unsynced: Vec<u8>,
    /// Whether it is unknown what the file holds after `synced`. Nothing is accepted before that was rewritten.
    needs_rewrite: bool,
}

impl SyncedFile {
    /// A file of which so many bytes are there and synced.
    pub fn new(medium: Box<dyn Medium>, synced: u64) -> SyncedFile {
        SyncedFile { medium, synced, unsynced: Vec::new(), needs_rewrite: false }
    }

    /// Whether it is still the file at a path, as it was left.
    pub fn is_ours(&self, path: &Path) -> bool {
        let known_length = (!self.needs_rewrite).then_some(self.length());
        self.medium.is_ours(path, known_length)
    }

    /// Whether it holds everything that was accepted.
    pub fn is_intact(&self) -> bool {
        !self.needs_rewrite
    }

    /// Whether accepted bytes may be lost by a power cut.
    pub fn has_unsynced(&self) -> bool {
        !self.unsynced.is_empty()
    }

    /// Everything that was accepted.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn accepted(&mut self) -> io::Result<Vec<u8>> {
        let mut bytes = self.medium.beginning(self.synced)?;
        bytes.extend_from_slice(&self.unsynced);
        Ok(bytes)
    }

    fn length(&self) -> u64 {
        self.synced + self.unsynced.len() as u64
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// The disk refuses. The file does not hold the bytes then, or is rewritten without them before more is accepted.
    pub fn append(&mut self, bytes: &[u8], durability: Durability) -> io::Result<()> {
        if self.needs_rewrite {
            self.rewrite()?;
        }
        if let Err(error) = self.medium.append(bytes) {
            // No sync has failed: what was accepted before is as it was.
            self.needs_rewrite = self.medium.cut(self.length()).is_err();
            return Err(error);
        }
        let accepted = self.unsynced.len();
        self.unsynced.extend_from_slice(bytes);
        if durability == Durability::Written {
            return Ok(());
        }
        self.sync().inspect_err(|_| {
            self.unsynced.truncate(accepted);
            // Should the program be killed now, the file holds what was accepted and not what was refused.
            let _ = self.restore_unsynced();
        })
    }

    /// Makes what was accepted survive a power cut. After a failed sync everything since the last successful one is written
    /// again and synced once more.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn sync(&mut self) -> io::Result<()> {
        match self.needs_rewrite {
            true => self.rewrite(),
            false => self.sync_once().or_else(|_| self.rewrite()),
        }
    }

    /// The same descriptor is used: it reports every write-back error since it was opened once. A new descriptor might be
    /// opened after such an error was reported, and would not report it.
    fn rewrite(&mut self) -> io::Result<()> {
        self.restore_unsynced()?;
        self.sync_once()
    }

    fn restore_unsynced(&mut self) -> io::Result<()> {
        self.medium.cut(self.synced)?;
        self.medium.append(&self.unsynced)
    }

    fn sync_once(&mut self) -> io::Result<()> {
        let synced = self.medium.sync();
        self.needs_rewrite = synced.is_err();
        if synced.is_ok() {
            self.synced = self.length();
            self.unsynced.clear();
        }
        synced
    }

    /// Puts another medium in place of the file.
    #[cfg(any(test, feature = "test-kit"))]
    pub fn replace_medium(&mut self, medium: Box<dyn Medium>) {
        self.medium = medium;
    }
}
