//! Who may look inside a run.

use std::path::Path;

use novamind_record::folder::manifest::Manifest;
use novamind_record::lesson::is_lesson_over;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Ended;
use novamind_tools::Refusal;

/// Said where hidden state is not shown.
pub const REFUSED_LOOK: &str = "the x-ray works in debug runs and in runs that are over";

/// Said where a lesson goes on.
const REFUSED_IN_LESSON: &str =
    "hidden state of a lesson is shown once its last part is over: the next part may have the same luck";

/// Whether hidden state of a run may be shown: of debug runs, and of runs that are over. Not where a study shows no results, as
/// none does of its practice: its session is still to come. Not where parts of a lesson are to come; the folder of the run
/// tells that.
pub fn may_look_inside(manifest: &Manifest, ended: Option<Ended>, folder: Option<&Path>) -> bool {
    let is_open = manifest.mode == Mode::Debug || (ended.is_some() && is_lesson_over(folder, manifest));
    is_open && !manifest.session_rules().hide_result(ended.is_some())
}

/// Refuses to look where hidden state stays hidden.
///
/// # Errors
/// `not_in_this_mode`.
pub(crate) fn refuse_to_look_inside(
    manifest: &Manifest,
    ended: Option<Ended>,
    folder: Option<&Path>,
) -> Result<(), Refusal> {
    if may_look_inside(manifest, ended, folder) {
        return Ok(());
    }
    let parts_are_to_come = ended.is_some() && manifest.lesson.is_some();
    let message = if parts_are_to_come { REFUSED_IN_LESSON } else { REFUSED_LOOK };
    Err(Refusal::new("not_in_this_mode", message))
}
