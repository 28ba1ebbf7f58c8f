//! Statements asked before, the newest first, to choose from.

use ratatui::layout::Rect;

use crate::console::action::Action;
use crate::console::canvas::{Canvas, centered};
use crate::console::screens::Look;
use crate::console::theme::Role;
use crate::console::widgets::{Cell, Column, Field, Table};

/// Statements of this run, and the list of them while it is open.
#[derive(Default)]
pub struct History {
    /// What was asked on this screen, the newest last.
    asked: Vec<String>,
    open: Option<(Vec<String>, Table)>,
}

/// What came of an action.
pub enum Choice {
    /// Nothing yet.
    None,
    /// This statement.
    Statement(String),
}

impl History {
    /// Remembers a statement.
    pub fn remember(&mut self, sql: &str) {
        self.asked.retain(|known| known != sql);
        self.asked.push(sql.to_owned());
    }

    /// Opens the list; `earlier` are statements of the run before, the newest last. False without any.
    pub fn open(&mut self, earlier: &[String]) -> bool {
        let mut all: Vec<String> = Vec::new();
        for sql in self.asked.iter().rev().chain(earlier.iter().rev()) {
            if !all.contains(sql) {
                all.push(sql.clone());
            }
        }
        let mut table = Table::new(vec![Column::words("statement").at_most(u16::MAX)]);
        let in_a_line = |sql: &String| sql.split_whitespace().collect::<Vec<_>>().join(" ");
        table.set_rows(all.iter().map(|sql| vec![Cell::words(in_a_line(sql))]).collect());
        let some = !all.is_empty();
        self.open = some.then_some((all, table));
        some
    }

    /// Whether the list is shown.
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Whether its filter is being typed.
    pub fn is_typing(&self) -> bool {
        self.open.as_ref().is_some_and(|(_, table)| table.is_typing())
    }

    /// The table of the list.
    pub fn table(&mut self) -> Option<&mut Table> {
        self.open.as_mut().map(|(_, table)| table)
    }

    /// The field of the filter.
    pub fn typing(&mut self) -> Option<&mut Field> {
        self.table().and_then(Table::typing)
    }

    /// Closes the list.
    pub fn close(&mut self) {
        self.open = None;
    }

    /// Walks, filters and chooses.
    pub fn act(&mut self, action: Action, page: u16) -> Choice {
        let Some((all, table)) = &mut self.open else { return Choice::None };
        let in_filter = table.is_typing();
        match action {
            Action::Commit | Action::CommitDown | Action::CommitNext | Action::CommitPrevious => {
                table.act(Action::Commit, page);
            }
            Action::Open => {
                let chosen = table.selected().map(|at| all[at].clone());
                self.open = None;
                return chosen.map_or(Choice::None, Choice::Statement);
            }
            _ if table.act(action, page) => {}
            Action::Close if !in_filter => self.open = None,
            _ => {}
        }
        Choice::None
    }

    /// Draws the list over the screen.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize, look: &Look<'_>) {
        let Some((all, table)) = &self.open else { return };
        let height = (all.len() as u16).saturating_add(3 + u16::from(table.is_typing())).max(5);
        let own = centered(
            area,
            area.width.saturating_sub(6).max(20),
            height.min(area.height.saturating_sub(2).max(5)),
        );
        canvas.clear(own, Role::Text);
        canvas.clicks.clear();
        let inside = canvas.pane(own, "Asked before", &table.note(), true);
        table.draw(canvas, inside, true, pane);
        canvas.pane_keys(own, &look.hints(&[Action::Open, Action::Filter, Action::Close]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_stand_once_the_newest_first() {
        let mut history = History::default();
        assert!(!history.open(&[]) && !history.is_open());
        for sql in ["SELECT 1", "SELECT 2", "SELECT 1"] {
            history.remember(sql);
        }
        assert!(history.open(&["SELECT 2".to_owned(), "SELECT 0".to_owned()]));
        let (all, _) = history.open.as_ref().expect("open");
        assert_eq!(all, &["SELECT 1", "SELECT 2", "SELECT 0"]);
        history.act(Action::Down, 5);
        assert!(matches!(history.act(Action::Open, 5), Choice::Statement(sql) if sql == "SELECT 2"));
        assert!(!history.is_open());
    }
}
