//! Causes of changes in figures, computed on a background thread while the run continues.

use std::path::{Path, PathBuf};

use super::background::lock_cache;
use super::{ActiveRun, SessionThread};
use crate::question::{Question, Reply};
use novamind_insight::{
    CauseProgress, ChangeExplanation, WeekQuantity, WeekQuestion, cause_analysis_folder,
    record_figure_inspection,
};
use novamind_tools::Rejection;

/// A question about the causes of a figure's change in a week.
#[derive(Debug, Clone)]
pub struct CausesQuestion {
    /// Weekly figure whose change is explained.
    pub quantity: WeekQuantity,
    /// The week, counted from 1, that is compared with the week before.
    pub week: u32,
}

impl Question for CausesQuestion {
    type Answer = ChangeExplanation;
    type Progress = CauseProgress;

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let Some(open) = &thread.active_run else { return };
        let question = WeekQuestion { quantity: self.quantity, week: Some(self.week) };
        let mut folder = recorded_folder(open);
        if question.quantity.is_hidden() {
            // Record the inspection before hidden state is shown.
            let looked = thread
                .inspection_session(false)
                .and_then(|session| record_figure_inspection(session, &question));
            folder = looked.and(folder);
        }
        let kept = thread.causes_cache.clone();
        reply.answer_on_thread(move |reply| {
            let mut kept = lock_cache(&kept);
            kept.get_or_open(folder?)?.explain(question, &|progress| {
                reply.report_progress(progress);
                reply.check_still_awaited()
            })
        });
    }
}

pub(super) fn recorded_folder(open: &ActiveRun) -> Result<PathBuf, Rejection> {
    match open {
        ActiveRun::Live(session) => cause_analysis_folder(session),
        // Permissions depend on the whole record, because the run may have ended after this position.
        ActiveRun::Playback(playback) => playback.session().folder().map(Path::to_owned).ok_or_else(|| {
            Rejection::new("not_possible", "not possible: this trajectory file has no run folder")
        }),
    }
}
