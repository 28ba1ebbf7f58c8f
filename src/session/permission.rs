//! Permission to inspect the hidden state of a run.

use std::path::Path;

use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::is_lesson_over;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::RunEndReason;
use novamind_tools::Rejection;

/// Rejection message if hidden state of a run must not be shown.
pub const INSPECTION_REJECTED: &str = "the x-ray is available in debug runs and in runs that have ended";

/// Rejection message for a run of an unfinished lesson.
const INSPECTION_REJECTED_IN_LESSON: &str =
    "hidden state of a lesson is shown after its last part: the next part can have the same random draws";

/// Returns whether hidden state of a run may be shown. Hidden state may be shown in debug runs and in runs that have
/// ended, unless the study withholds results. Every study withholds results of practice runs. For lesson runs, the last
/// part of the lesson must have ended.
pub fn can_inspect(manifest: &Manifest, ended: Option<RunEndReason>, folder: Option<&Path>) -> bool {
    let is_open = manifest.mode == Mode::Debug || (ended.is_some() && is_lesson_over(folder, manifest));
    is_open && !manifest.session_rules().hides_result(ended.is_some())
}

/// Rejects the inspection of a run whose hidden state must not be shown.
///
/// # Errors
/// The rejection `not_in_this_mode`.
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
