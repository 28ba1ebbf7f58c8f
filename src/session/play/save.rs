//! Saving an open run: lines, database and snapshot.

use super::Session;
use crate::snapshot::file::{KeptState, SnapshotPlace};
use novamind_record::error::RunError;

impl Session {
    /// Saves everything.
    ///
    /// # Errors
    /// The disk fails.
    pub fn save(&mut self) -> Result<(), RunError> {
        self.log.sync()?;
        self.keep_snapshot(|| self.state_hash().0, true);
        Ok(self.database.wait()?)
    }

    /// Stores the current state as a snapshot and commits the database. A run without a folder has no snapshot. With
    /// `closing`, the snapshot also contains the digest of the database file. Disk errors are ignored: without a
    /// snapshot, opening only takes longer.
    pub(super) fn keep_snapshot(&self, state_hash: impl FnOnce() -> String, closing: bool) {
        let Some(folder) = self.folder.as_ref().filter(|_| self.log.is_written()) else {
            return self.commit_projection();
        };
        // Commit lines without rows too: a snapshot ahead of the database could not be used.
        self.commit_projection();
        self.write_snapshot_of(state_hash(), SnapshotPlace::of(folder, &self.seal_key), closing);
    }

    /// Writes a snapshot of the current state. With `closing`, it contains the digest of the database file.
    pub(crate) fn write_snapshot(&self, place: SnapshotPlace, closing: bool) {
        self.write_snapshot_of(self.state_hash().0, place, closing);
    }

    fn write_snapshot_of(&self, state_hash: String, place: SnapshotPlace, closing: bool) {
        let Session { manifest, simulation, history, surroundings, .. } = self;
        let notebook = &surroundings.notebook;
        let position = self.log.position().clone();
        let kept = KeptState { manifest, simulation, history, notebook, position };
        self.database.then(closing, kept.writer(state_hash, place));
    }
}
