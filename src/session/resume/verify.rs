//! Verification of recorded runs.

use std::path::Path;

use crate::play::Session;
use crate::resume::origin::{Origin, read_origin};
use crate::snapshot::integrity::Integrity;
use crate::snapshot::sealing::SealKey;
use novamind_record::error::RunError;

/// The result of a verification.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verification {
    /// Identifier of the run.
    pub run: String,
    /// Number of checked lines.
    pub lines: usize,
    /// Number of weeks and steps whose state was reproduced.
    pub states: usize,
    /// Last day.
    pub day: u32,
    /// Hash of the last state.
    pub state_hash: String,
}

/// Simulates a recorded run again, from a folder or a trajectory file, and compares every recorded state. Changes
/// nothing.
///
/// # Errors
/// The first line that does not reproduce, or the run is missing or of another version.
pub fn verify(path: &Path) -> Result<Verification, RunError> {
    verify_sealed(path, &SealKey::default())
}

/// Like [`verify`], for a run whose snapshots are sealed with `key`.
///
/// # Errors
/// As [`verify`].
pub fn verify_sealed(path: &Path, key: &SealKey) -> Result<Verification, RunError> {
    let (origin, trajectory) = read_origin(path)?;
    let Origin { path, folder, manifest, params } = origin;
    if let Some(folder) = &folder {
        Integrity::read(folder, &manifest, key).check(&path, &trajectory)?;
    }
    let run = manifest.id.clone();
    let mut session = Session::read_only(manifest, None, params, None);
    for line in &trajectory.lines {
        session.apply_line(&path, line)?;
    }
    let states = trajectory.lines.iter().filter(|line| line.closes_days());
    let last = trajectory.lines.iter().rev().find_map(|line| line.record.closing());
    Ok(Verification {
        run,
        lines: trajectory.lines.len(),
        states: states.count(),
        day: session.day(),
        state_hash: last.map(|closing| closing.state_hash.clone()).unwrap_or_default(),
    })
}
