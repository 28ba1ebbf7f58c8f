//! Every key that works here.

use ratatui::layout::Rect;

use super::{Dialog, Outcome};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, centered};
use crate::console::keys::Keys;
use crate::console::screens::Look;
use crate::console::theme::Role;
use crate::console::widgets::{Cell, Column, Table};

/// The keys of some scopes.
pub struct Help {
    table: Table,
}

impl Help {
    /// Shows the keys of a focused place, the innermost scope first.
    pub fn new(keys: &Keys, scopes: &[Scope]) -> Help {
        let columns = vec![
            Column::words("where").at_most(8),
            Column::words("keys").at_most(16),
            Column::words("what").at_most(14),
            Column::words("").at_most(90),
        ];
        let mut table = Table::new(columns);
        let row = |(scope, chords, title, doc): (Scope, String, &str, &str)| {
            let keys = if chords.is_empty() {
                Cell::words("palette").role(Role::Dim)
            } else {
                Cell::words(chords).role(Role::Key)
            };
            vec![
                Cell::words(scope.id()).role(Role::Dim),
                keys,
                Cell::words(title),
                Cell::words(doc).role(Role::Text),
            ]
        };
        table.set_rows(keys.help(scopes).into_iter().map(row).collect());
        Help { table }
    }
}

impl Dialog for Help {
    fn scopes(&self) -> Vec<Scope> {
        if self.table.is_typing() { vec![Scope::Field] } else { vec![Scope::List, Scope::Dialog] }
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Filter, Action::Close]
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        if self.table.act(action, look.page) {
            return Outcome::stay();
        }
        match action {
            Action::Close | Action::Cancel => Outcome::close(),
            _ => Outcome::stay(),
        }
    }

    fn key(&mut self, key: &crossterm::event::KeyEvent, _: &Look<'_>) -> Outcome {
        self.table.edit_filter(|field| {
            field.key(key);
        });
        Outcome::stay()
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        self.table.select_place(row);
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, area.width.saturating_sub(4).min(110), area.height.saturating_sub(2));
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, "Keys that work here", &self.table.note(), true);
        self.table.draw(
            canvas,
            Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside },
            true,
            0,
        );
        canvas.pane_keys(own, &look.hints(&[Action::Filter, Action::Close]));
    }
}
