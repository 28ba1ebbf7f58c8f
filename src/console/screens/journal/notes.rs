//! Notes of the run.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;

use super::{Journal, JournalPane};
use crate::action::{Action, Scope};
use crate::context::{EditorDocument, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_tui::canvas::Canvas;

pub struct NotesPane;

impl Pane<Journal> for NotesPane {
    fn scopes(&self, journal: &Journal) -> Vec<Scope> {
        if journal.editing { vec![Scope::Editor, Scope::Notes] } else { vec![Scope::Notes, Scope::List] }
    }

    fn hints(&self, journal: &Journal) -> Vec<Action> {
        match journal.editing {
            true => vec![Action::SaveNotes, Action::LeaveEditor],
            false => vec![Action::EditNotes, Action::SaveNotes],
        }
    }

    fn handle_action(&self, journal: &mut Journal, action: Action, _: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Close {
            journal.focus = JournalPane::List;
        }
        Vec::new()
    }

    fn handle_key(&self, journal: &mut Journal, key: &KeyEvent, _: &ScreenContext<'_>) -> Vec<Effect> {
        if key.code == KeyCode::BackTab {
            return vec![Effect::Execute(Action::FocusPrevious)];
        }
        if journal.editing {
            journal.notes.handle_key(key);
        }
        Vec::new()
    }

    fn paste(&self, journal: &mut Journal, text: &str, _: &ScreenContext<'_>) -> Vec<Effect> {
        if journal.editing {
            journal.notes.insert(text);
        }
        Vec::new()
    }

    fn editor_document(&self, journal: &Journal) -> Option<EditorDocument> {
        Some(EditorDocument { text: journal.notes.text(), extension: "md" })
    }

    fn replace_document(&self, journal: &mut Journal, text: &str) -> Vec<Effect> {
        journal.notes.set_text(text);
        Vec::new()
    }

    fn border(&self, journal: &Journal, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let keys: &[Action] = match (journal.editing, journal.has_unsaved_notes()) {
            (true, _) => &[Action::SaveNotes, Action::LeaveEditor],
            (false, true) => &[Action::EditNotes, Action::SaveNotes],
            (false, false) => &[Action::EditNotes],
        };
        PaneBorder {
            title: "Notes".to_owned(),
            note: if journal.has_unsaved_notes() { "draft, unsaved".to_owned() } else { String::new() },
            keys: context.hints(keys),
            shows_keys_always: true,
        }
    }

    fn draw(&self, journal: &Journal, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        journal.notes.draw(canvas, placement.area, journal.editing, "notes to yourself, saved with the run");
    }
}
