//! The database of a run that nobody plays, brought up to date on its disk; the run itself is only read.

use std::path::Path;
use std::sync::Arc;

use super::integrity::Integrity;
use super::open::{Access, check_start, open_projector, usable};
use super::sealing::SealKey;
use super::snapshot::SnapshotPlace;
use crate::session::error::RunError;
use crate::session::folder::derived::Derived;
use crate::session::folder::lock::lock_run;
use crate::session::state::Session;
use crate::session::trajectory::Trajectory;

/// Brings `world.db` up to the last line of the trajectory, or makes it anew. `progress` is told each day that is reached
/// and the last day of the run. The key is that of the run's snapshots.
///
/// # Errors
/// The run is damaged, of another version, or in use; its folder cannot be written.
pub fn rebuild_database(
    folder: &Path,
    key: &SealKey,
    progress: &mut dyn FnMut(u32, u32),
) -> Result<(), RunError> {
    let Derived { manifest, .. } = Derived::of(folder)?;
    let params = Arc::new(manifest.params()?);
    let _lock = lock_run(folder, &manifest.id)?;
    let path = folder.join("trajectory.jsonl");
    let mut integrity = Integrity::of(folder, &manifest, key);
    let trajectory = Trajectory::read(&path)?;
    check_start(&path, trajectory.lines.first(), &manifest)?;
    integrity.check(&path, &trajectory)?;
    let sound = integrity.vouch_for_database(folder);
    let database = open_projector(folder, Access::Write, (&manifest, &params), &trajectory, sound)?;
    let rows = database.1.as_ref().map_or(0, |position| position.seq);
    let snapshot = usable(&integrity, &manifest, &trajectory, Some(rows));
    let days = manifest.days;
    let lines = &trajectory.lines;
    let (mut session, seen) = Session::before_replay(manifest.clone(), folder, params, lines, snapshot);
    session.replay(&path, &trajectory, seen, Some(database), &mut |day| progress(day, days))?;
    session.projection.wait()?;
    // The file is another one now: what vouched for the old one would call it damaged.
    if let Some(closed) = integrity.snapshot.filter(|snapshot| snapshot.database().is_some()) {
        let place = SnapshotPlace::of(folder, key);
        session.projection.then(true, move |digest| closed.vouch_for(&place, digest));
        session.projection.wait()?;
    }
    Ok(())
}
