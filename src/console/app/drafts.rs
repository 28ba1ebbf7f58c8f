//! Drafts: unsent texts are saved with the run while the user edits them. The console offers the saved drafts when the
//! run is opened again.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::{App, Layer, Stage};
use crate::dialogs::restore_drafts::RestoreDraftsDialog;
use novamind_record::trajectory::record::{TextEdit, TextEditOutcome};
use novamind_session::DraftTexts;

/// Maximum time between a change of a draft and its storage. A draft that is younger is lost if the program is killed.
const SAVE_INTERVAL: Duration = Duration::from_secs(1);

#[derive(Default)]
pub(super) struct DraftState {
    /// The drafts that were saved last, or `None` if unknown.
    saved: Option<DraftTexts>,
    /// Error of the last attempt to save the drafts.
    error: Arc<Mutex<Option<String>>>,
    /// Time of the next check for changed drafts.
    due: Option<Duration>,
    /// Drafts of an earlier session that the user has not restored or discarded yet. The draft file stays until the
    /// user decides.
    offered_drafts: Option<Box<DraftTexts>>,
}

impl App {
    pub(super) fn schedule_draft_save(&mut self) {
        let soon = self.stopwatch.elapsed() + SAVE_INTERVAL;
        self.drafts.due.get_or_insert(soon);
    }

    pub(super) fn draft_save_due(&self) -> Option<Duration> {
        self.drafts.due
    }

    pub(super) fn save_drafts_if_due(&mut self, now: Duration) {
        if self.drafts.due.is_some_and(|due| due <= now) {
            self.save_drafts();
        }
    }

    pub(super) fn save_drafts(&mut self) {
        self.drafts.due = None;
        let texts = self.collect_drafts();
        let is_saved = self.drafts.saved.as_ref() == Some(&texts) && self.draft_save_error().is_none();
        if self.drafts.offered_drafts.is_none() && !is_saved {
            self.drafts.saved = Some(texts.clone());
            let result = self.drafts.error.clone();
            self.record(move |session| {
                let error = session.draft_file().save(&texts).err().map(|error| error.to_string());
                *result.lock().unwrap_or_else(PoisonError::into_inner) = error;
            });
        }
    }

    /// Returns the error of the last attempt to save the drafts.
    pub(super) fn draft_save_error(&self) -> Option<String> {
        self.drafts.error.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn collect_drafts(&self) -> DraftTexts {
        let Some(run) = self.run().filter(|run| run.playback.is_none() && run.company.is_running()) else {
            return DraftTexts::default();
        };
        let (rationale, forecasts) = run.next_week.draft();
        let (post, answers) = run.screens.social.draft_text();
        let sql = run.screens.sql.draft();
        let is_known = |sql: &str| {
            let asked = run.company.past_queries.iter().map(String::as_str);
            let named = self.library.queries().iter().map(|query| query.sql.as_str());
            asked.chain(named).any(|known| known.trim() == sql.trim())
        };
        DraftTexts {
            rationale,
            forecasts,
            notes: run.screens.journal.unsaved_notes(),
            sql: if sql.trim().is_empty() || is_known(&sql) { String::new() } else { sql },
            answers: answers.filter(|_| !post.is_empty()),
            post,
            offers: run.screens.inbox.draft_offers(&run.company),
            forms: run.screens.tools.draft_values(),
        }
    }

    pub(super) fn offer_drafts(&mut self, texts: DraftTexts) {
        if texts.is_empty() || !self.run().is_some_and(|run| run.company.is_running()) {
            return;
        }
        self.push_layer(Layer::Dialog(Box::new(RestoreDraftsDialog::new(texts.texts_by_field()))));
        self.drafts.offered_drafts = Some(Box::new(texts));
    }

    pub(super) fn resolve_draft_offer(&mut self, restore: bool) {
        let Some(texts) = self.drafts.offered_drafts.take() else { return };
        self.drafts.saved = None;
        if !restore {
            self.show_status("drafts discarded");
            return self.save_drafts();
        }
        for (place, text) in texts.texts_by_field() {
            self.record_draft(restored_draft(place, &text));
        }
        if let Stage::Run(run) = &mut self.stage {
            run.next_week.restore_draft(&texts.rationale, &texts.forecasts);
            if let Some(notes) = &texts.notes {
                run.screens.journal.restore_notes(notes);
            }
            if !texts.sql.is_empty() {
                run.screens.sql.set_statement(&texts.sql);
            }
            run.screens.social.restore_draft(&texts.post, texts.answers);
            run.screens.inbox.restore_offers(&texts.offers);
            for (tool, values) in &texts.forms {
                run.screens.tools.restore_drafts(*tool, values, &run.company);
            }
        }
        self.show_status("drafts restored");
        self.save_drafts();
    }

    pub(super) fn reset_drafts(&mut self) {
        self.drafts = DraftState::default();
    }
}

fn restored_draft(place: String, text: &str) -> TextEdit {
    TextEdit {
        place,
        outcome: TextEditOutcome::Restored,
        length: text.chars().count() as u64,
        typed: 0,
        deleted: 0,
        pasted: 0,
        pauses: 0,
        for_ms: 0,
        text: None,
    }
}
