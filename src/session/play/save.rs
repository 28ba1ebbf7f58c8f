//! Saving an open run: lines, database and snapshot.

use super::Session;
use crate::snapshot::file::{SnapshotSource, SnapshotTarget};
use novamind_record::error::RunError;

impl Session {
    /// Saves all lines, a snapshot and the database.
    ///
    /// # Errors
    /// The trajectory or the database cannot be written.
    pub fn save(&mut self) -> Result<(), RunError> {
        self.log.sync()?;
        self.save_snapshot(|| self.state_hash().0, true);
        Ok(self.database.wait_until_written()?)
    }

    /// Stores the current state as a snapshot and commits the database. A run in memory has no snapshot. If `closing`
    /// is true, the snapshot also contains the digest of the database file. Ignores disk errors: if there is no
    /// snapshot, opening the run only takes longer.
    pub(super) fn save_snapshot(&self, state_hash: impl FnOnce() -> String, closing: bool) {
        let Some(folder) = self.folder.as_ref().filter(|_| self.log.is_written()) else {
            return self.commit_projection();
        };
        // Also commit lines without rows, because a snapshot that is ahead of the database cannot be used.
        self.commit_projection();
        self.write_snapshot_with_hash(state_hash(), SnapshotTarget::new(folder, &self.seal_key), closing);
    }

    /// Writes a snapshot of the current state. If `closing` is true, the snapshot contains the digest of the database
    /// file.
    pub(crate) fn write_snapshot(&self, place: SnapshotTarget, closing: bool) {
        self.write_snapshot_with_hash(self.state_hash().0, place, closing);
    }

    fn write_snapshot_with_hash(&self, state_hash: String, place: SnapshotTarget, closing: bool) {
        let Session { manifest, simulation, history, context, .. } = self;
        let notebook = &context.notebook;
        let position = self.log.position().clone();
        let kept = SnapshotSource { manifest, simulation, history, notebook, position };
        self.database.after_writes(closing, kept.writer(state_hash, place));
    }
}
