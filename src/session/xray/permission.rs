//! Who may look, and what a look leaves behind.

use std::path::Path;

use crate::lesson::over::is_lesson_over;
use crate::state::Session;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::mode::Mode;
use novamind_record::trajectory::record::{Activity, Ended, XrayLook};
use novamind_record::trajectory::{Durability, Record};
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
    is_open && !manifest.session_rules().hide_result(ended)
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

    /// Begins a look at a day, the last one if none is named: it is refused, or recorded before anything is shown. The day that
    /// it shows.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `read_only`, `not_saved`.
    pub(crate) fn begin_look(&mut self, what: &str, which: &str, day: Option<u32>) -> Result<u32, Refusal> {
        self.refuse_to_look_inside()?;
        let day = self.day_to_show(day)?;
        self.record_look_inside(what, which, day)?;
        Ok(day)
    }

    /// Records a look, before anything is shown.
    ///
    /// # Errors
    /// `read_only` where the run has nothing that writes it, `not_saved`.
    pub(crate) fn record_look_inside(
        &mut self,
        what: &str,
        which: &str,
        shown_day: u32,
    ) -> Result<(), Refusal> {
        if !self.records_looks() {
            let message = "a look is recorded, and this run is open read-only; open it as for play";
            return Err(Refusal::new("read_only", message));
        }
        let look = XrayLook { what: what.to_owned(), which: which.to_owned(), shown_day };
        let line = Record::Activity(Activity::Xray(look));
        let appended = self.append(&line, Durability::Synced);
        appended.map(drop).map_err(|error| Refusal::new("not_saved", error.to_string()))
    }

    /// The day that is asked for; the last one if none is.
    ///
    /// # Errors
    /// `day_unknown`: it has not been simulated.
    pub(crate) fn day_to_show(&self, day: Option<u32>) -> Result<u32, Refusal> {
        let last = self.day();
        let refused = |message: String| Err(Refusal::at("day", "day_unknown", message));
        match day.unwrap_or(last) {
            _ if last == 0 => refused("no day has run yet".to_owned()),
            day if (1..=last).contains(&day) => Ok(day),
            day => refused(format!("there is no day {day}; choose a day from 1 to {last}")),
        }
    }
}
