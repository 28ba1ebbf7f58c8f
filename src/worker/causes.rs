//! Causes of changes of figures, computed on their own thread while the run continues.

use std::path::{Path, PathBuf};

use super::answering::lock_kept;
use super::{Open, SessionThread};
use crate::asking::{Question, Reply};
use novamind_insight::{WeekQuantity, WeekQuestion, Why, WhyProgress, folder_of_causes, look_at_figure};
use novamind_tools::Refusal;

/// Asks for the causes of a figure's change in a week.
#[derive(Debug, Clone)]
pub struct WhyQuestion {
    /// The figure.
    pub quantity: WeekQuantity,
    /// The week.
    pub week: u32,
}

impl Question for WhyQuestion {
    type Answer = Why;
    type Progress = WhyProgress;

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let Some(open) = &thread.open else { return };
        let question = WeekQuestion { quantity: self.quantity, week: Some(self.week) };
        let mut folder = folder_of(open);
        if question.quantity.is_hidden() {
            // The inspection is recorded before anything is shown.
            let looked =
                thread.session_to_look_into(false).and_then(|session| look_at_figure(session, &question));
            folder = looked.and(folder);
        }
        let kept = thread.causes.clone();
        reply.answer_on_thread(move |reply| {
            let mut kept = lock_kept(&kept);
            kept.of(folder?)?.why(question, &|progress| {
                reply.report(progress);
                reply.go_on()
            })
        });
    }
}

pub(super) fn folder_of(open: &Open) -> Result<PathBuf, Refusal> {
    match open {
        Open::Played(session) => folder_of_causes(session),
        // Permissions depend on the whole record: the run may have ended after this position.
        Open::Replayed(playback) => playback.session().folder().map(Path::to_owned).ok_or_else(|| {
            Refusal::new("not_possible", "not possible: this trajectory file has no run folder")
        }),
    }
}
