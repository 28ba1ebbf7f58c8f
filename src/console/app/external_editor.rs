//! Texts in the user's editor: which texts can be opened, when the editor is rejected, and the text that it returns.

use super::{App, Order, Stage};
use crate::attention::EditSource;
use crate::dialogs::text_dialog::TextDialog;

impl App {
    pub(super) fn open_external_editor(&mut self) {
        if let Some(reason) = self.external_editor_rejection() {
            return self.show_error(reason);
        }
        let document = self.with_screen(|screen, _| screen.editor_document()).flatten();
        if let Some(document) = document {
            self.save_drafts();
            self.is_editing_externally = true;
            self.orders.push(Order::OpenEditor(document));
        }
    }

    /// Returns why the focused text cannot be opened in the user's editor, or `None` if it can.
    pub fn external_editor_rejection(&self) -> Option<&'static str> {
        const WRONG_TEXT: &str = "your editor opens notes, posts, SQL and code only";
        let Stage::Run(run) = &self.stage else { return Some(WRONG_TEXT) };
        // The console cannot record another program, so sessions of participants do not allow external editors.
        let is_recorded =
            run.company.is_baseline() && run.company.is_running() || run.company.study.is_some();
        if is_recorded || self.study.is_some() {
            return Some("not in a baseline run: your editor is not recorded");
        }
        let has_document = self.layers.is_empty() && run.screens.get(run.screen).editor_document().is_some();
        (!has_document).then_some(WRONG_TEXT)
    }

    /// Stores the text that the user's editor returned. An error contains the reason why the text is unchanged.
    pub(super) fn finish_external_edit(&mut self, result: Result<String, String>) {
        self.is_editing_externally = false;
        let now = self.stopwatch.elapsed();
        // The console received no keys while the editor was open. The user was present, so no idle period is recorded.
        for (event, idle_ms, window) in self.presence.handle_input(false, now) {
            self.record_presence(event, idle_ms, window);
        }
        let text = match result {
            Ok(text) => text,
            Err(reason) => return self.open_dialog(TextDialog::new("Your editor", reason)),
        };
        let before = self.edited_text();
        let is_same = self.with_screen(|screen, _| screen.editor_document()).flatten();
        if is_same.is_some_and(|document| document.text == text) {
            return self.show_status("the text is unchanged");
        }
        let effects =
            self.with_screen(|screen, context| screen.replace_document(&text, context)).unwrap_or_default();
        self.execute_effects(effects);
        if let (Some((place, old)), Some((_, new))) = (before, self.edited_text()) {
            self.typing_log.record_change(&place, &old, new, EditSource::Pasted, now);
        }
        self.schedule_draft_save();
        self.show_status("the text from your editor is in the draft");
    }
}
