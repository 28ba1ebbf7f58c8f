//! What was done and why, how the forecasts turned out, and the notes of the run.

pub mod entries;
mod list;
mod notes;
mod scores;
#[cfg(test)]
mod tests;

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use super::panes::{Pane, Paned, draw_pane};
use super::{Figure, Look, ScreenState};
use crate::console::action::Action;
use crate::console::canvas::Canvas;
use crate::console::effect::Effect;
use crate::console::request::Request;
use crate::console::theme::Role;
use crate::console::widgets::{Cell, Column, Editor, Table};

/// Its panes, in the order of the tab key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, VariantArray)]
pub enum JournalPane {
    /// What was done.
    List,
    /// Notes to oneself.
    Notes,
    /// How forecasts turned out.
    Scores,
}

/// The screen.
pub struct Journal {
    focus: JournalPane,
    table: Table,
    /// Title and text of the whole entry behind every row.
    wholes: Vec<(String, String)>,
    /// What every row is about.
    figures: Vec<Figure>,
    /// The selected horizon of the forecasts.
    horizon: usize,
    notes: Editor,
    /// The notes as they are kept.
    kept: String,
    editing: bool,
}

impl Default for Journal {
    fn default() -> Self {
        let columns = vec![Column::numbers("day"), Column::words("what").at_most(u16::MAX)];
        Journal {
            focus: JournalPane::List,
            table: Table::new(columns),
            wholes: Vec::new(),
            figures: Vec::new(),
            horizon: 0,
            notes: Editor::default(),
            kept: String::new(),
            editing: false,
        }
    }
}

impl Journal {
    fn is_draft(&self) -> bool {
        self.notes.text() != self.kept
    }

    /// Notes that differ from those that are kept.
    pub fn unsaved(&self) -> Option<String> {
        self.is_draft().then(|| self.notes.text())
    }

    /// Puts notes that were not saved back.
    pub fn restore(&mut self, notes: &str) {
        self.notes = Editor::of(notes);
    }

    fn save(&mut self) -> Vec<Effect> {
        self.editing = false;
        if self.is_draft() {
            vec![Effect::Request(Request::SetMemo(self.notes.text()))]
        } else {
            vec![Effect::Say("notes already saved".to_owned())]
        }
    }
}

impl ScreenState for Journal {
    fn opened(&self) -> usize {
        usize::from(self.focus != JournalPane::List)
    }

    fn renew(&mut self, look: &Look<'_>) {
        let mut rows = Vec::new();
        self.wholes.clear();
        self.figures.clear();
        for line in entries::lines(look.company) {
            rows.push(vec![
                Cell::number(f64::from(line.day), line.day.to_string()).role(Role::Dim),
                Cell::words(line.text).role(line.role),
            ]);
            self.figures.push(Figure { title: line.title.clone(), term: line.term, sql: line.sql, why: None });
            self.wholes.push((line.title, line.whole));
        }
        self.table.set_rows(rows);
        // The editor has its own idea of line ends: only like is compared with like.
        let kept = Editor::of(&look.company.memo);
        if !self.is_draft() && kept.text() != self.kept {
            self.notes = kept.clone();
        }
        self.kept = kept.text();
    }

    fn edited(&self) -> Option<(String, String)> {
        self.editing.then(|| ("notes".to_owned(), self.notes.text()))
    }

    fn holds_unsent_text(&self) -> bool {
        self.is_draft()
    }
}

impl Paned for Journal {
    type Name = JournalPane;

    fn panes(&self) -> &'static [JournalPane] {
        JournalPane::VARIANTS
    }

    fn pane(name: JournalPane) -> &'static dyn Pane<Journal> {
        match name {
            JournalPane::List => &list::EntriesPane,
            JournalPane::Notes => &notes::NotesPane,
            JournalPane::Scores => &scores::ScoresPane,
        }
    }

    fn focused(&self) -> JournalPane {
        self.focus
    }

    fn focus_on(&mut self, name: JournalPane) {
        self.focus = name;
        self.editing = false;
    }

    fn act_anywhere(&mut self, action: Action, _: &Look<'_>) -> Option<Vec<Effect>> {
        match action {
            Action::EditMemo => (self.focus, self.editing) = (JournalPane::Notes, true),
            Action::SaveMemo => return Some(self.save()),
            Action::LeaveEditor => self.editing = false,
            _ => return None,
        }
        Some(Vec::new())
    }

    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        if area.width < 60 || area.height < 14 {
            return draw_pane(self, self.focus, canvas, area, look);
        }
        let few = look.company.scores.len() as u16 + 4;
        let [list, scores, notes] = if area.width >= 104 {
            let right = (area.width / 3).clamp(48, 64);
            let [list, side] =
                Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
            // Single forecasts below the scores, where there is room for some of them.
            let tall = (few + 9).min(side.height / 2).max(few);
            let [scores, notes] =
                Layout::vertical([Constraint::Length(tall), Constraint::Min(0)]).areas(side);
            [list, scores, notes]
        } else {
            let [list, below] = Layout::vertical([Constraint::Min(0), Constraint::Length(few)]).areas(area);
            let [scores, notes] =
                Layout::horizontal([Constraint::Length(40), Constraint::Min(0)]).areas(below);
            [list, scores, notes]
        };
        draw_pane(self, JournalPane::List, canvas, list, look);
        draw_pane(self, JournalPane::Scores, canvas, scores, look);
        draw_pane(self, JournalPane::Notes, canvas, notes, look);
    }
}
