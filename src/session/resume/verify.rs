//! Verification of recorded runs by simulating them again.

use std::path::Path;

use crate::play::Session;
use crate::resume::origin::{Origin, read_origin};
use crate::snapshot::integrity::Integrity;
use crate::snapshot::sealing::SealKey;
use novamind_record::error::RunError;

/// The result of a successful verification.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verification {
    /// ID of the run.
    pub run: String,
    /// Number of checked lines.
    pub lines: usize,
    /// Number of weeks and single-day steps whose state was reproduced.
    pub states: usize,
    /// Last simulated day.
    pub day: u32,
    /// Hash of the last recorded state.
    pub state_hash: String,
}

/// Simulates a recorded run again, from a run folder or a trajectory file, and compares every recorded state. Does not
/// change any files.
///
/// # Errors
/// A line does not reproduce the recorded state, or the run is missing or was recorded with another version.
pub fn verify(path: &Path) -> Result<Verification, RunError> {
    verify_sealed(path, &SealKey::default())
}

/// Verifies a run like [`verify`]. The snapshots of the run are sealed with `key`.
///
/// # Errors
/// The same errors as [`verify`].
pub fn verify_sealed(path: &Path, key: &SealKey) -> Result<Verification, RunError> {
    let (origin, trajectory) = read_origin(path)?;
    let Origin { path, folder, manifest, params } = origin;
    if let Some(folder) = &folder {
        Integrity::read(folder, &manifest, key).check(&path, &trajectory)?;
    }
    let run = manifest.id.clone();
    let mut session = Session::new_read_only(manifest, None, params, None);
    for line in &trajectory.lines {
        session.apply_line(&path, line)?;
    }
    let states = trajectory.lines.iter().filter(|line| line.closes_days());
    let last = trajectory.lines.iter().rev().find_map(|line| line.record.closed_days());
    Ok(Verification {
        run,
        lines: trajectory.lines.len(),
        states: states.count(),
        day: session.day(),
        state_hash: last.map(|closing| closing.state_hash.clone()).unwrap_or_default(),
    })
}
