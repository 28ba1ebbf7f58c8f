//! An append-only file that tracks which bytes survive a power cut.
//!
//! After a failed sync, the kernel may mark pages clean that it never wrote. A later sync then succeeds without
//! writing these pages. Therefore bytes stay in memory until a sync succeeds, and are rewritten after a failed sync.

use std::io;
use std::path::Path;

use super::medium::Medium;
use super::writer::Durability;

/// A file that consists of `synced` bytes, which survive a power cut, and the bytes in `unsynced`.
pub(super) struct SyncedFile {
    medium: Box<dyn Medium>,
    /// Length of the prefix that a successful sync covers.
    synced: u64,
    /// Accepted bytes after the synced prefix.
    unsynced: Vec<u8>,
    /// Whether the content after `synced` is unknown. If true, `unsynced` must be rewritten before more bytes are
    /// accepted.
    needs_rewrite: bool,
}

impl SyncedFile {
    pub fn new(medium: Box<dyn Medium>, synced: u64) -> SyncedFile {
        SyncedFile { medium, synced, unsynced: Vec::new(), needs_rewrite: false }
    }

    /// Returns whether `path` still names the open file and no other program has changed the file.
    pub fn is_file_at(&self, path: &Path) -> bool {
        let known_length = (!self.needs_rewrite).then_some(self.length());
        self.medium.is_file_at(path, known_length)
    }

    /// Returns whether the file contains all accepted bytes.
    pub fn is_complete(&self) -> bool {
        !self.needs_rewrite
    }

    /// Returns whether a power cut could lose accepted bytes.
    pub fn has_unsynced(&self) -> bool {
        !self.unsynced.is_empty()
    }

    /// Returns all accepted bytes.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn accepted_bytes(&mut self) -> io::Result<Vec<u8>> {
        let mut bytes = self.medium.read_prefix(self.synced)?;
        bytes.extend_from_slice(&self.unsynced);
        Ok(bytes)
    }

    fn length(&self) -> u64 {
        self.synced + self.unsynced.len() as u64
    }

    /// Appends bytes, and syncs the file if `durability` requires it.
    ///
    /// # Errors
    /// The file cannot be written. In this case, the file does not contain the new bytes, or is rewritten without
    /// these bytes before the next append.
    pub fn append(&mut self, bytes: &[u8], durability: Durability) -> io::Result<()> {
        if self.needs_rewrite {
            self.rewrite_unsynced()?;
        }
        if let Err(error) = self.medium.append(bytes) {
            // No sync has failed, so the previously accepted bytes are intact.
            self.needs_rewrite = self.medium.truncate(self.length()).is_err();
            return Err(error);
        }
        let accepted = self.unsynced.len();
        self.unsynced.extend_from_slice(bytes);
        if durability == Durability::Written {
            return Ok(());
        }
        self.sync().inspect_err(|_| {
            self.unsynced.truncate(accepted);
            // If the program is killed now, the file contains only the accepted bytes.
            let _ = self.restore_unsynced();
        })
    }

    /// Syncs the accepted bytes. After a failed sync, rewrites the bytes since the last successful sync and syncs once
    /// more.
    ///
    /// # Errors
    /// The file cannot be written or synced.
    pub fn sync(&mut self) -> io::Result<()> {
        match self.needs_rewrite {
            true => self.rewrite_unsynced(),
            false => self.sync_once().or_else(|_| self.rewrite_unsynced()),
        }
    }

    /// Rewrites and syncs the bytes after the synced prefix. Uses the same file descriptor, because a new descriptor
    /// would not report earlier write-back errors.
    fn rewrite_unsynced(&mut self) -> io::Result<()> {
        self.restore_unsynced()?;
        self.sync_once()
    }

    fn restore_unsynced(&mut self) -> io::Result<()> {
        self.medium.truncate(self.synced)?;
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

    /// Replaces the medium in tests.
    #[cfg(any(test, feature = "test-kit"))]
    pub fn replace_medium(&mut self, medium: Box<dyn Medium>) {
        self.medium = medium;
    }
}
