//! Recovery of the undamaged prefix of a damaged run as a branch. The damaged run is not changed.

use std::path::Path;
use std::sync::Arc;

use super::branch::create_branch;
use crate::play::Session;
use crate::snapshot::integrity::Integrity;
use crate::snapshot::sealing::SealKey;
use novamind_record::error::RunError;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::{ManifestCheck, check_start};
use novamind_record::mode::Mode;
use novamind_record::trajectory::{CHAIN_BROKEN_MESSAGE, Line, RECOVERY_HINT, Trajectory};

/// The result of a recovery.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecoveredRun {
    /// ID of the new run.
    pub run: String,
    /// Mode of the new run.
    pub mode: Mode,
    /// Number of recovered lines, counted from the first line.
    pub lines: usize,
    /// Last day of the new run.
    pub day: u32,
    /// Description of the damage.
    pub problem: String,
}

/// Creates a branch from the lines that are certainly valid according to checksums or a reproduced state. The branch
/// of a baseline run is a sandbox run. `key` is the seal key of the run's snapshots.
///
/// # Errors
/// The run is not damaged, none of its lines can be used, or the branch cannot be written.
pub fn recover(folder: &Path, key: &SealKey) -> Result<RecoveredRun, RunError> {
    recover_prefix(folder, key).map_err(without_recovery_hint)
}

/// Removes the hint to recover the run, because the recovery has just failed.
fn without_recovery_hint(error: RunError) -> RunError {
    match error {
        RunError::Damaged { path, line, problem, remedy } => {
            RunError::Damaged { path, line, problem, remedy: remedy.replace(RECOVERY_HINT, "") }
        }
        RunError::InvalidRequest(message) => RunError::InvalidRequest(message.replace(RECOVERY_HINT, "")),
        other => other,
    }
}

fn recover_prefix(folder: &Path, key: &SealKey) -> Result<RecoveredRun, RunError> {
    let path = folder.join("trajectory.jsonl");
    let bytes = std::fs::read(&path).map_err(RunError::io(&path))?;
    let mut trajectory = Trajectory::default();
    let mut problem = trajectory.append_bytes(&bytes).err();
    let first = trajectory.lines.first();
    let ManifestCheck { manifest, .. } = ManifestCheck::read(folder)?;
    check_start(&path, first, &manifest)?;
    let good = count_valid_lines(&path, &manifest, &trajectory.lines, &mut problem)?;
    let words = match &problem {
        Some((line, problem)) => format!("line {line}: {problem}"),
        None => match Integrity::read(folder, &manifest, key).check(&path, &trajectory) {
            Err(RunError::Damaged { line, problem, .. }) => format!("line {line}: {problem}"),
            Err(problem) => problem.to_string(),
            Ok(()) => {
                let message = format!("run {} is not damaged; there is nothing to recover", manifest.id);
                return Err(RunError::InvalidRequest(message));
            }
        },
    };
    let mode = manifest.mode.branch_mode();
    let branch = create_branch(folder, &manifest, &trajectory.lines[..good], mode)
        .map_err(|rejection| RunError::InvalidRequest(rejection.message))?;
    let (run, day) = (branch.manifest().id.clone(), branch.day());
    Ok(RecoveredRun { run, mode, lines: good, day, problem: words })
}

/// Returns the number of certainly valid lines. Sets `problem` if a line does not reproduce the recorded state.
fn count_valid_lines(
    path: &Path,
    manifest: &Manifest,
    lines: &[Line],
    problem: &mut Option<(usize, String)>,
) -> Result<usize, RunError> {
    let params = Arc::new(manifest.load_params()?);
    let mut session = Session::new_read_only(manifest.clone(), None, params, None);
    // Number of lines up to the last reproduced state; at least 1.
    let mut reached = 1;
    for (at, line) in lines.iter().enumerate() {
        if let Err(error) = session.apply_line(path, line) {
            let words = match error {
                RunError::Damaged { problem, .. } => problem,
                other => other.to_string(),
            };
            *problem = Some((at + 1, words));
            // If the last line fails, only this line is invalid. If an earlier line fails, any line since the last
            // reproduced state may be invalid.
            return Ok(if at + 1 == lines.len() { at } else { reached });
        }
        if line.closes_days() {
            reached = at + 1;
        }
    }
    let has_checksums = lines.first().is_some_and(Line::declares_checksums);
    // A checksum validates a line, unless the hash in the next line differs. Lines without checksums are validated
    // only by a reproduced state.
    let doubtful = problem.as_ref().is_some_and(|(_, words)| !has_checksums || words == CHAIN_BROKEN_MESSAGE);
    Ok(if doubtful { reached.max(lines.len() - 1) } else { lines.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::playback::tests::{RecordedRun, record_run};
    use crate::resume::verify::verify;

    /// Damages a copy of a run's trajectory and recovers it.
    fn recover_damaged(run: &RecordedRun, damage: impl Fn(&mut Vec<u8>)) -> Result<RecoveredRun, RunError> {
        let path = run.folder.join("trajectory.jsonl");
        let whole = std::fs::read(&path).expect("a trajectory");
        let mut bytes = whole.clone();
        damage(&mut bytes);
        std::fs::write(&path, &bytes).expect("written");
        let recovered = recover(&run.folder, &SealKey::default());
        assert_eq!(std::fs::read(&path).expect("a trajectory"), bytes, "the damaged run was changed");
        std::fs::write(&path, whole).expect("written");
        recovered
    }

    fn line_start(bytes: &[u8], line: usize) -> usize {
        let ends = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1);
        std::iter::once(0).chain(ends).nth(line).expect("the line exists")
    }

    #[test]
    fn recover_keeps_only_valid_lines_for_every_flipped_byte() {
        let run = record_run(Mode::Sandbox, 3);
        let bytes = std::fs::read(run.folder.join("trajectory.jsonl")).expect("a trajectory");
        let whole = Trajectory::parse(&bytes).expect("it is intact");
        for line in 1..whole.lines.len() {
            let (from, to) = (line_start(&bytes, line), line_start(&bytes, line + 1));
            // Offset of a byte at the start, in the middle or at the end of the line.
            let at = [from + 2, from + (to - from) / 2, to - 3][line % 3];
            let found = recover_damaged(&run, |bytes| bytes[at] ^= 0x04);
            let Ok(found) = found else {
                // Damage in the last line is detected only by the state or the database.
                assert_eq!(line + 1, whole.lines.len(), "{found:?}");
                continue;
            };
            assert_eq!(found.lines, line, "line {} is damaged: {found:?}", line + 1);
            let branch = run.folder.with_file_name(&found.run);
            assert_eq!(verify(&branch).expect("an intact run").day, found.day);
            std::fs::remove_dir_all(branch).expect("removed");
        }
    }

    #[test]
    fn recover_keeps_weeks_before_missing_lines_in_a_sandbox_run() {
        let run = record_run(Mode::Baseline, 3);
        let found = recover_damaged(&run, |bytes| {
            let middle = line_start(bytes, 9) + 20;
            bytes.drain(middle..middle + 30);
        });
        let found = found.expect("a branch");
        assert_eq!((found.mode, found.day, found.lines), (Mode::Sandbox, 7, 9));
        assert!(found.problem.contains("line"), "{}", found.problem);
        let manifest = Manifest::read(&run.folder.with_file_name(&found.run)).expect("a manifest");
        assert_eq!(manifest.parent.expect("a parent").run, run.id);
    }

    #[test]
    fn recover_works_without_a_manifest() {
        let run = record_run(Mode::Sandbox, 2);
        std::fs::write(run.folder.join("run.toml"), "seed = [").expect("written");
        let whole = recover(&run.folder, &SealKey::default())
            .expect_err("the first line replaces the manifest")
            .to_string();
        assert!(whole.contains("not damaged"), "{whole}");
        let found = recover_damaged(&run, |bytes| bytes.truncate(bytes.len() - 1))
            .err()
            .map(|error| error.to_string());
        assert!(found.is_some_and(|words| words.contains("not damaged")), "an unfinished line is not damage");
        let found = recover_damaged(&run, |bytes| {
            let at = line_start(bytes, 9) + 20;
            bytes[at] ^= 4;
        });
        assert_eq!(found.expect("a branch").lines, 9);
    }

    #[test]
    fn recover_rejects_intact_runs_and_runs_without_a_first_line() {
        let run = record_run(Mode::Sandbox, 1);
        let whole = recover(&run.folder, &SealKey::default()).expect_err("it is intact").to_string();
        assert!(whole.contains("not damaged"), "{whole}");
        let problem = recover_damaged(&run, |bytes| bytes[3] ^= 0x04)
            .expect_err("the first line is damaged")
            .to_string();
        assert!(problem.contains("start of a run"), "{problem}");
    }

    #[test]
    fn recover_does_not_advise_to_recover() {
        let message = |remedy: &str| format!("Lines 1 to 3 are good; nothing was changed{remedy}");
        let damaged = RunError::Damaged {
            path: "trajectory.jsonl".into(),
            line: 4,
            problem: "the line is missing".to_owned(),
            remedy: message(RECOVERY_HINT),
        };
        let invalid = RunError::InvalidRequest(message(RECOVERY_HINT));
        for error in [damaged, invalid] {
            let text = without_recovery_hint(error).to_string();
            assert!(text.ends_with(&message("")), "{text}");
        }
    }
}
