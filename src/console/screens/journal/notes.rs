//! Notes of the run.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;

use super::{Journal, JournalPane};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_tui::canvas::Canvas;

pub struct NotesPane;

impl Pane<Journal> for NotesPane {
    fn scopes(&self, journal: &Journal) -> Vec<Scope> {
        if journal.editing { vec![Scope::Editor, Scope::Memo] } else { vec![Scope::Memo, Scope::List] }
    }

    fn hints(&self, journal: &Journal) -> Vec<Action> {
        match journal.editing {
            true => vec![Action::SaveMemo, Action::LeaveEditor],
            false => vec![Action::EditMemo, Action::SaveMemo],
        }
    }

    fn act(&self, journal: &mut Journal, action: Action, _: &Look<'_>) -> Vec<Effect> {
        if action == Action::Close {
            journal.focus = JournalPane::List;
        }
        Vec::new()
    }

    fn key(&self, journal: &mut Journal, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        if key.code == KeyCode::BackTab {
            return vec![Effect::Do(Action::FocusPrevious)];
        }
        if journal.editing {
            journal.notes.key(key);
        }
        Vec::new()
    }

    fn paste(&self, journal: &mut Journal, text: &str, _: &Look<'_>) -> Vec<Effect> {
        if journal.editing {
            journal.notes.insert(text);
        }
        Vec::new()
    }

    fn border(&self, journal: &Journal, _: Rect, look: &Look<'_>) -> Border {
        let keys: &[Action] = match (journal.editing, journal.is_draft()) {
            (true, _) => &[Action::SaveMemo, Action::LeaveEditor],
            (false, true) => &[Action::EditMemo, Action::SaveMemo],
            (false, false) => &[Action::EditMemo],
        };
        Border {
            title: "Notes".to_owned(),
            note: if journal.is_draft() { "draft, unsaved".to_owned() } else { String::new() },
            keys: look.hints(keys),
            keys_always: true,
        }
    }

    fn draw(&self, journal: &Journal, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        journal.notes.draw(canvas, seat.area, journal.editing, "notes to yourself, saved with the run");
    }
}
