//! Keeping what an open run has reached: lines, database and snapshot.

use super::Session;
use crate::snapshot::file::{KeptState, SnapshotPlace};
use novamind_record::error::RunError;

impl Session {
    /// Puts everything on the disk.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn save(&mut self) -> Result<(), RunError> {
        self.log.sync()?;
        self.keep_snapshot(|| self.state_hash().0, true);
        Ok(self.database.wait()?)
    }

    /// Keeps the present state, which has this hash, as a snapshot, and has the database take in everything up to now; a
    /// run without a folder keeps none. A closing one vouches for the database's file too. A disk that refuses it takes
    /// away nothing but time.
    pub(super) fn keep_snapshot(&self, state_hash: impl FnOnce() -> String, closing: bool) {
        let Some(folder) = self.folder.as_ref().filter(|_| self.log.is_written()) else {
            return self.commit_projection();
        };
        // Lines without rows move the database on, too: a snapshot ahead of it could not be used.
        self.commit_projection();
        self.write_snapshot_of(state_hash(), SnapshotPlace::of(folder, &self.seal_key), closing);
    }

    /// Writes the present state as a snapshot. If `closing`, it vouches for the database's file.
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
