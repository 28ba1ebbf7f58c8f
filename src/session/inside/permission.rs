//! Who may look inside a run.

use std::path::Path;

use crate::state::Session;
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

impl Session {
    /// Whether its hidden state may be shown, as [`may_look_inside`] says.
    pub fn may_look_inside(&self) -> bool {
        may_look_inside(&self.manifest, self.history.ended, self.folder.as_deref())
    }

    /// Refuses to look where hidden state stays hidden; the answer depends on nothing but the mode of the run, its study, its
    /// lesson and whether they are over.
    ///
    /// # Errors
    /// `not_in_this_mode`.
    pub fn refuse_to_look_inside(&self) -> Result<(), Refusal> {
        if self.may_look_inside() {
            return Ok(());
        }
        let parts_are_to_come = self.history.ended.is_some() && self.manifest.lesson.is_some();
        let message = if parts_are_to_come { REFUSED_IN_LESSON } else { REFUSED_LOOK };
        Err(Refusal::new("not_in_this_mode", message))
    }

    /// Whether a look becomes a line: not where the run is only read, or played again.
    pub fn records_looks(&self) -> bool {
        self.recorder.is_some()
    }
}
