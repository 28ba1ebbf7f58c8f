//! Recovery of the undamaged prefix of a damaged run, as a branch. The run itself is not changed.

use std::path::Path;
use std::sync::Arc;

use super::branch::branch_of;
use crate::play::Session;
use crate::snapshot::integrity::Integrity;
use crate::snapshot::sealing::SealKey;
use novamind_record::error::RunError;
use novamind_record::folder::derived::{Derived, check_start};
use novamind_record::folder::manifest::Manifest;
use novamind_record::mode::Mode;
use novamind_record::trajectory::{DOES_NOT_FOLLOW, Line, Trajectory};

/// The result of a recovery.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rescued {
    /// The new run.
    pub run: String,
    /// Its mode.
    pub mode: Mode,
    /// Number of recovered lines, from the first.
    pub lines: usize,
    /// Last day of the new run.
    pub day: u32,
    /// The damage.
    pub problem: String,
}

/// Creates a branch from the lines that are certainly valid, by their checksums or by a reproduced state. A baseline
/// run becomes a sandbox. `key` is the key of the run's snapshots.
///
/// # Errors
/// The run is not damaged, no line of it can be used, or the branch cannot be written.
pub fn rescue(folder: &Path, key: &SealKey) -> Result<Rescued, RunError> {
    let path = folder.join("trajectory.jsonl");
    let bytes = std::fs::read(&path).map_err(RunError::io(&path))?;
    let mut trajectory = Trajectory::default();
    let mut problem = trajectory.extend(&bytes).err();
    let first = trajectory.lines.first();
    let Derived { manifest, .. } = Derived::of(folder)?;
    check_start(&path, first, &manifest)?;
    let good = replayed(&path, &manifest, &trajectory.lines, &mut problem)?;
    let words = match &problem {
        Some((line, problem)) => format!("line {line}: {problem}"),
        None => match Integrity::of(folder, &manifest, key).check(&path, &trajectory) {
            Err(problem) => problem.to_string(),
            Ok(()) => {
                let message = format!("run {} is not damaged; there is nothing to recover", manifest.id);
                return Err(RunError::NotPossible(message));
            }
        },
    };
    let mode = manifest.mode.of_branch();
    let branch = branch_of(folder, &manifest, &trajectory.lines[..good], mode)
        .map_err(|refusal| RunError::NotPossible(refusal.message))?;
    let (run, day) = (branch.manifest().id.clone(), branch.day());
    Ok(Rescued { run, mode, lines: good, day, problem: words })
}

/// Returns the number of certainly valid lines. Sets `problem` if a state does not reproduce.
fn replayed(
    path: &Path,
    manifest: &Manifest,
    lines: &[Line],
    problem: &mut Option<(usize, String)>,
) -> Result<usize, RunError> {
    let params = Arc::new(manifest.params()?);
    let mut session = Session::unwritten(manifest.clone(), None, params, None);
    // Number of lines up to the last reproduced state; at least the first.
    let mut reached = 1;
    for (at, line) in lines.iter().enumerate() {
        if let Err(error) = session.apply_line(path, line) {
            let words = match error {
                RunError::Damaged { problem, .. } => problem,
                other => other.to_string(),
            };
            *problem = Some((at + 1, words));
            // If the last line fails, only this line is invalid. If an earlier line fails, all lines since the last
            // reproduced state are doubtful.
            return Ok(if at + 1 == lines.len() { at } else { reached });
        }
        if line.closes_days() {
            reached = at + 1;
        }
    }
    let summed = lines.first().is_some_and(Line::promises_sums);
    // A checksum validates a line, unless the next line contradicts it. Lines without checksums are validated only by
    // their state.
    let doubtful = problem.as_ref().is_some_and(|(_, words)| !summed || words == DOES_NOT_FOLLOW);
    Ok(if doubtful { reached.max(lines.len() - 1) } else { lines.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::playback::tests::{Recorded, recorded};
    use crate::resume::verify::verify;

    /// Damages a copy of a run's trajectory and recovers it.
    fn rescued(run: &Recorded, damage: impl Fn(&mut Vec<u8>)) -> Result<Rescued, RunError> {
        let path = run.folder.join("trajectory.jsonl");
        let whole = std::fs::read(&path).expect("a trajectory");
        let mut bytes = whole.clone();
        damage(&mut bytes);
        std::fs::write(&path, &bytes).expect("written");
        let rescued = rescue(&run.folder, &SealKey::default());
        assert_eq!(std::fs::read(&path).expect("a trajectory"), bytes, "the damaged run was changed");
        std::fs::write(&path, whole).expect("written");
        rescued
    }

    fn start_of(bytes: &[u8], line: usize) -> usize {
        let ends = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1);
        std::iter::once(0).chain(ends).nth(line).expect("so many lines")
    }

    #[test]
    fn whatever_byte_is_flipped_only_lines_that_are_true_are_kept() {
        let run = recorded(Mode::Sandbox, 3);
        let bytes = std::fs::read(run.folder.join("trajectory.jsonl")).expect("a trajectory");
        let whole = Trajectory::parse(&bytes).expect("it is whole");
        for line in 1..whole.lines.len() {
            let (from, to) = (start_of(&bytes, line), start_of(&bytes, line + 1));
            // A position at the start, in the middle or at the end of the line.
            let at = [from + 2, from + (to - from) / 2, to - 3][line % 3];
            let found = rescued(&run, |bytes| bytes[at] ^= 0x04);
            let Ok(found) = found else {
                // Damage in the last line is detected only by its state or by the database.
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
    fn a_cut_in_the_middle_keeps_the_weeks_before_it_and_a_baseline_becomes_a_sandbox() {
        let run = recorded(Mode::Baseline, 3);
        let found = rescued(&run, |bytes| {
            let middle = start_of(bytes, 9) + 20;
            bytes.drain(middle..middle + 30);
        });
        let found = found.expect("a branch");
        assert_eq!((found.mode, found.day, found.lines), (Mode::Sandbox, 7, 9));
        assert!(found.problem.contains("line"), "{}", found.problem);
        let manifest = Manifest::read(&run.folder.with_file_name(&found.run)).expect("a manifest");
        assert_eq!(manifest.parent.expect("a parent").run, run.id);
    }

    #[test]
    fn without_a_manifest_a_damaged_run_is_rescued_all_the_same() {
        let run = recorded(Mode::Sandbox, 2);
        std::fs::write(run.folder.join("run.toml"), "seed = [").expect("written");
        let whole = rescue(&run.folder, &SealKey::default())
            .expect_err("the first line replaces the manifest")
            .to_string();
        assert!(whole.contains("not damaged"), "{whole}");
        let found =
            rescued(&run, |bytes| bytes.truncate(bytes.len() - 1)).err().map(|error| error.to_string());
        assert!(found.is_some_and(|words| words.contains("not damaged")), "an unfinished line is not damage");
        let found = rescued(&run, |bytes| {
            let at = start_of(bytes, 9) + 20;
            bytes[at] ^= 4;
        });
        assert_eq!(found.expect("a branch").lines, 9);
    }

    #[test]
    fn nothing_is_rescued_of_a_whole_run_or_without_a_first_line() {
        let run = recorded(Mode::Sandbox, 1);
        let whole = rescue(&run.folder, &SealKey::default()).expect_err("it is whole").to_string();
        assert!(whole.contains("not damaged"), "{whole}");
        let problem = rescued(&run, |bytes| bytes[3] ^= 0x04).expect_err("no beginning").to_string();
        assert!(problem.contains("start of a run"), "{problem}");
    }
}
