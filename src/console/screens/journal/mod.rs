//! Journal: actions with rationales, forecast results, and notes.

mod branches;
pub mod entries;
mod list;
mod notes;
mod scores;
#[cfg(test)]
mod tests;

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use super::ScreenState;
use super::panes::{Pane, Paned, draw_pane};
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use novamind_insight::Kin;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, Editor, Table};
use novamind_worker::asking::Pending;
use novamind_worker::questions::RelatedRunsQuestion;
use novamind_worker::request::Request;

/// Panes in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, VariantArray)]
pub enum JournalPane {
    /// Journal entries.
    List,
    /// Notes of the run.
    Notes,
    /// Forecast results.
    Scores,
    /// Tree of related runs, if there is one.
    Branches,
}

/// The journal screen.
pub struct Journal {
    focus: JournalPane,
    table: Table,
    /// Title and text of the complete entry of each row.
    wholes: Vec<(String, String)>,
    figures: Vec<Figure>,
    horizon: usize,
    notes: Editor,
    kept: String,
    editing: bool,
    /// The tree, with a row for each of its runs.
    tree: Vec<Kin>,
    branches: Table,
    is_tree_read: bool,
    asked: Pending<RelatedRunsQuestion>,
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
            tree: Vec::new(),
            branches: branches::table(),
            is_tree_read: false,
            asked: Pending::default(),
        }
    }
}

impl Journal {
    fn is_draft(&self) -> bool {
        self.notes.text() != self.kept
    }

    /// Returns the unsaved notes, if they differ from the saved ones.
    pub fn unsaved(&self) -> Option<String> {
        self.is_draft().then(|| self.notes.text())
    }

    /// Restores unsaved notes.
    pub fn restore(&mut self, notes: &str) {
        self.notes = Editor::of(notes);
    }

    fn save(&mut self) -> Vec<Effect> {
        self.editing = false;
        if self.is_draft() {
            vec![Effect::Request(Request::SetMemo(self.notes.text()))]
        } else {
            vec![Effect::Say("Notes already saved".to_owned())]
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
            self.figures.push(Figure {
                title: line.title.clone(),
                term: line.term,
                sql: line.sql,
                why: None,
            });
            self.wholes.push((line.title, line.whole));
        }
        self.table.set_rows(rows);
        // The editor normalizes line ends, so both sides must be normalized.
        let kept = Editor::of(&look.company.memo);
        if !self.is_draft() && kept.text() != self.kept {
            self.notes = kept.clone();
        }
        self.kept = kept.text();
    }

    fn ask_run(&mut self, look: &Look<'_>) -> Vec<Effect> {
        self.ask_tree(look.company)
    }

    fn take_answers(&mut self, look: &Look<'_>) -> Vec<Effect> {
        match self.asked.try_take() {
            Some((_, Ok(tree))) => self.take_tree(tree, look.company),
            Some((_, Err(refusal))) => return vec![Effect::Complain(refusal.message)],
            None => {}
        }
        Vec::new()
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
        match self.has_tree() {
            true => JournalPane::VARIANTS,
            false => &[JournalPane::List, JournalPane::Notes, JournalPane::Scores],
        }
    }

    fn pane(name: JournalPane) -> &'static dyn Pane<Journal> {
        match name {
            JournalPane::List => &list::EntriesPane,
            JournalPane::Notes => &notes::NotesPane,
            JournalPane::Scores => &scores::ScoresPane,
            JournalPane::Branches => &branches::BranchesPane,
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
            Action::ShowTree if self.has_tree() => self.focus_on(JournalPane::Branches),
            Action::ShowTree => {
                return Some(vec![Effect::Complain("This run has no related runs".to_owned())]);
            }
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
        let wide = area.width >= 104;
        let [list, below] = if wide {
            let right = (area.width / 3).clamp(48, 64);
            Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area)
        } else {
            Layout::vertical([Constraint::Min(0), Constraint::Length(few)]).areas(area)
        };
        let (list, below) = self.arrange_tree(canvas, (list, below), area, look);
        draw_pane(self, JournalPane::List, canvas, list, look);
        let [scores, notes] = if wide {
            // Individual forecasts below the scores, if some of them fit.
            let tall = (few + 9).min(below.height / 2).max(few);
            Layout::vertical([Constraint::Length(tall), Constraint::Min(0)]).areas(below)
        } else {
            Layout::horizontal([Constraint::Length(40), Constraint::Min(0)]).areas(below)
        };
        draw_pane(self, JournalPane::Scores, canvas, scores, look);
        draw_pane(self, JournalPane::Notes, canvas, notes, look);
    }
}

/// Minimum height for the tree next to all other panes.
const ROOM_FOR_TREE: u16 = 26;

impl Journal {
    /// Draws the tree, if there is one: below the list, or in low windows in place of the lower panes while
    /// it has the focus. Returns the areas for the list and the other panes.
    fn arrange_tree(
        &self,
        canvas: &mut Canvas<'_>,
        (list, below): (Rect, Rect),
        area: Rect,
        look: &Look<'_>,
    ) -> (Rect, Rect) {
        let has_focus = self.focus == JournalPane::Branches;
        if !self.has_tree() {
            return (list, below);
        }
        if area.height < ROOM_FOR_TREE {
            return match has_focus {
                true => {
                    let [list, tree] =
                        Layout::vertical([Constraint::Length(area.height / 3), Constraint::Min(0)])
                            .areas(Rect { width: list.width, ..area });
                    draw_pane(self, JournalPane::Branches, canvas, tree, look);
                    (list, if below.x > list.x { below } else { Rect::default() })
                }
                false => (list, below),
            };
        }
        let wanted = self.tree.len() as u16 + branches::AROUND + 3;
        let tall = wanted.min(list.height / 2);
        let [list, tree] = Layout::vertical([Constraint::Min(0), Constraint::Length(tall)]).areas(list);
        draw_pane(self, JournalPane::Branches, canvas, tree, look);
        (list, below)
    }
}
