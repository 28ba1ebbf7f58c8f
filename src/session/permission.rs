//! Permission to inspect a run.

use std::path::Path;

use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::is_lesson_over;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::RunEndReason;
use novamind_tools::Rejection;

/// Message if hidden state is not shown.
pub const INSPECTION_REJECTED: &str = "the x-ray works in debug runs and in runs that are over";

/// Message for an unfinished lesson.
const INSPECTION_REJECTED_IN_LESSON: &str =
    "hidden state of a lesson is shown after its last part: the next part can have the same random draws";

/// Returns whether hidden state of a run may be shown: in debug runs, and in runs that have ended. Not if the study withholds
/// results, as every study does for practice runs. Not before the last part of a lesson has ended, which the folder
/// of the run records.
pub fn can_inspect(manifest: &Manifest, ended: Option<RunEndReason>, folder: Option<&Path>) -> bool {
    let is_open = manifest.mode == Mode::Debug || (ended.is_some() && is_lesson_over(folder, manifest));
    is_open && !manifest.session_rules().hides_result(ended.is_some())
}

/// Rejects the inspection of a run whose hidden state must not be shown.
///
/// # Errors
/// `not_in_this_mode`.
pub(crate) fn check_inspection(
    manifest: &Manifest,
    ended: Option<RunEndReason>,
    folder: Option<&Path>,
) -> Result<(), Rejection> {
    if can_inspect(manifest, ended, folder) {
        return Ok(());
    }
    let parts_are_to_come = ended.is_some() && manifest.lesson.is_some();
    let message = if parts_are_to_come { INSPECTION_REJECTED_IN_LESSON } else { INSPECTION_REJECTED };
    Err(Rejection::new("not_in_this_mode", message))
}
