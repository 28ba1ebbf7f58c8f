//! Drafts: unsent texts are saved with the run while they are edited, and offered when it is opened again.

use std::time::Duration;

use super::{App, Layer, Stage};
use crate::dialogs::restore::Restore;
use novamind_record::trajectory::record::{Draft, DraftOutcome};
use novamind_session::UnsentTexts;

const BETWEEN_KEEPING: Duration = Duration::from_secs(3);

#[derive(Default)]
pub(super) struct TextsKept {
    /// The drafts as last saved, or `None` if unknown.
    texts: Option<UnsentTexts>,
    /// When they are compared again.
    due: Option<Duration>,
    /// Drafts of an earlier session, until the user restores or discards them. Their file stays until then.
    offered: Option<Box<UnsentTexts>>,
}

impl App {
    pub(super) fn touch_texts(&mut self) {
        let soon = self.stopwatch.now() + BETWEEN_KEEPING;
        self.unsent.due.get_or_insert(soon);
    }

    pub(super) fn texts_due(&self) -> Option<Duration> {
        self.unsent.due
    }

    pub(super) fn keep_texts_in_time(&mut self, now: Duration) {
        if self.unsent.due.is_some_and(|due| due <= now) {
            self.keep_texts();
        }
    }

    pub(super) fn keep_texts(&mut self) {
        self.unsent.due = None;
        let texts = self.unsent_texts();
        if self.unsent.offered.is_none() && self.unsent.texts.as_ref() != Some(&texts) {
            self.unsent.texts = Some(texts.clone());
            self.record(move |session| session.drafts().keep(&texts));
        }
    }

    fn unsent_texts(&self) -> UnsentTexts {
        let Some(run) = self.run().filter(|run| run.viewer.is_none() && run.company.is_running()) else {
            return UnsentTexts::default();
        };
        let (rationale, forecasts) = run.filing.unsent();
        let (post, answers) = run.screens.social.unsent();
        let sql = run.screens.sql.unsent();
        let is_known = |sql: &str| {
            let asked = run.company.asked.iter().map(String::as_str);
            let named = self.library.queries().iter().map(|query| query.sql.as_str());
            asked.chain(named).any(|known| known.trim() == sql.trim())
        };
        UnsentTexts {
            rationale,
            forecasts,
            notes: run.screens.journal.unsaved(),
            sql: if sql.trim().is_empty() || is_known(&sql) { String::new() } else { sql },
            answers: answers.filter(|_| !post.is_empty()),
            post,
            forms: run.screens.tools.typed_values(),
        }
    }

    pub(super) fn offer_texts(&mut self, texts: UnsentTexts) {
        if texts.is_empty() || !self.run().is_some_and(|run| run.company.is_running()) {
            return;
        }
        self.lay(Layer::Dialog(Box::new(Restore::new(texts.places()))));
        self.unsent.offered = Some(Box::new(texts));
    }

    pub(super) fn settle_offer(&mut self, restore: bool) {
        let Some(texts) = self.unsent.offered.take() else { return };
        self.unsent.texts = None;
        if !restore {
            self.say("drafts discarded");
            return self.keep_texts();
        }
        for (place, text) in texts.places() {
            self.note_draft(restored(place, &text));
        }
        if let Stage::Run(run) = &mut self.stage {
            run.filing.restore(&texts.rationale, &texts.forecasts);
            if let Some(notes) = &texts.notes {
                run.screens.journal.restore(notes);
            }
            if !texts.sql.is_empty() {
                run.screens.sql.edit(&texts.sql);
            }
            run.screens.social.restore(&texts.post, texts.answers);
            for (tool, values) in &texts.forms {
                run.screens.tools.restore(*tool, values, &run.company);
            }
        }
        self.say("drafts restored");
        self.keep_texts();
    }

    pub(super) fn forget_texts(&mut self) {
        self.unsent = TextsKept::default();
    }
}

fn restored(place: String, text: &str) -> Draft {
    Draft {
        place,
        outcome: DraftOutcome::Restored,
        length: text.chars().count() as u64,
        typed: 0,
        deleted: 0,
        pasted: 0,
        pauses: 0,
        for_ms: 0,
        text: None,
    }
}
