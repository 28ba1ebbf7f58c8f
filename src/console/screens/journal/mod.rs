//! Journal: actions with rationales, forecast results, and notes.

mod branches;
pub mod entries;
mod entries_pane;
mod notes;
mod scores;
#[cfg(test)]
mod tests;

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane, draw_stack};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use novamind_insight::RelatedRun;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn, TextEditor, Table};
use novamind_worker::question::Pending;
use novamind_worker::page_questions::RelatedRunsQuestion;
use novamind_worker::request::Request;

/// Panes of the journal in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, VariantArray)]
pub enum JournalPane {
    /// Journal entries.
    List,
    /// Notes of the run.
    Notes,
    /// Forecast scores by horizon.
    Scores,
    /// Tree of related runs, if the run is a branch or has branches.
    Branches,
}

/// The journal screen.
pub struct Journal {
    focus: JournalPane,
    table: Table,
    /// Title and text of the complete entry for each row of the table.
    full_texts: Vec<(String, String)>,
    figures: Vec<Figure>,
    horizon: usize,
    notes: TextEditor,
    saved_notes: String,
    editing: bool,
    /// Related runs in tree order. Each run has a row in `branches`.
    tree: Vec<RelatedRun>,
    branches: Table,
    is_tree_read: bool,
    asked: Pending<RelatedRunsQuestion>,
}

impl Default for Journal {
    fn default() -> Self {
        let columns = vec![TableColumn::numeric("day"), TableColumn::text("what").with_max_width(u16::MAX)];
        Journal {
            focus: JournalPane::List,
            table: Table::new(columns),
            full_texts: Vec::new(),
            figures: Vec::new(),
            horizon: 0,
            notes: TextEditor::default(),
            saved_notes: String::new(),
            editing: false,
            tree: Vec::new(),
            branches: branches::empty_table(),
            is_tree_read: false,
            asked: Pending::default(),
        }
    }
}

impl Journal {
    fn has_unsaved_notes(&self) -> bool {
        self.notes.text() != self.saved_notes
    }

    /// Returns the notes in the editor if they differ from the saved notes.
    pub fn unsaved_notes(&self) -> Option<String> {
        self.has_unsaved_notes().then(|| self.notes.text())
    }

    /// Restores unsaved notes in the editor.
    pub fn restore_notes(&mut self, notes: &str) {
        self.notes = TextEditor::with_text(notes);
    }

    fn save_notes(&mut self) -> Vec<Effect> {
        self.editing = false;
        if self.has_unsaved_notes() {
            vec![Effect::Request(Request::SetNotes(self.notes.text()))]
        } else {
            vec![Effect::ShowStatus("Notes already saved".to_owned())]
        }
    }
}

impl ScreenState for Journal {
    fn screen_escape_depth(&self) -> usize {
        usize::from(self.focus != JournalPane::List)
    }

    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        let mut rows = Vec::new();
        self.full_texts.clear();
        self.figures.clear();
        for line in entries::journal_lines(context.company) {
            rows.push(vec![
                TableCell::from_number(f64::from(line.day), line.day.to_string()).with_role(Role::Dim),
                TableCell::from_text(line.text).with_role(line.role),
            ]);
            self.figures.push(Figure {
                title: line.title.clone(),
                term: line.term,
                sql: line.sql,
                week_quantity: None,
            });
            self.full_texts.push((line.title, line.full_text));
        }
        self.table.set_rows(rows);
        // The editor normalizes line ends, so the saved notes are normalized before the comparison.
        let kept = TextEditor::with_text(&context.company.notes);
        if !self.has_unsaved_notes() && kept.text() != self.saved_notes {
            self.notes = kept.clone();
        }
        self.saved_notes = kept.text();
    }

    fn request_data(&mut self, context: &ScreenContext<'_>) -> Vec<Effect> {
        self.request_tree(context.company)
    }

    fn take_answers(&mut self, context: &ScreenContext<'_>) -> Vec<Effect> {
        match self.asked.try_take() {
            Some((_, Ok(tree))) => self.set_tree(tree, context.company),
            Some((_, Err(rejection))) => return vec![Effect::ShowError(rejection.message)],
            None => {}
        }
        Vec::new()
    }

    fn edited_text(&self) -> Option<(String, String)> {
        self.editing.then(|| ("notes".to_owned(), self.notes.text()))
    }

    fn has_unsent_text(&self) -> bool {
        self.has_unsaved_notes()
    }
}

impl PaneScreen for Journal {
    type PaneId = JournalPane;

    fn panes(&self) -> &'static [JournalPane] {
        match self.has_tree() {
            true => JournalPane::VARIANTS,
            false => &[JournalPane::List, JournalPane::Notes, JournalPane::Scores],
        }
    }

    fn pane(name: JournalPane) -> &'static dyn Pane<Journal> {
        match name {
            JournalPane::List => &entries_pane::EntriesPane,
            JournalPane::Notes => &notes::NotesPane,
            JournalPane::Scores => &scores::ScoresPane,
            JournalPane::Branches => &branches::BranchesPane,
        }
    }

    fn focused_pane(&self) -> JournalPane {
        self.focus
    }

    fn set_focused_pane(&mut self, name: JournalPane) {
        self.focus = name;
        self.editing = false;
    }

    fn handle_screen_action(&mut self, action: Action, _: &ScreenContext<'_>) -> Option<Vec<Effect>> {
        match action {
            Action::EditNotes => (self.focus, self.editing) = (JournalPane::Notes, true),
            Action::ShowTree if self.has_tree() => self.set_focused_pane(JournalPane::Branches),
            Action::ShowTree => {
                return Some(vec![Effect::ShowError("This run has no related runs".to_owned())]);
            }
            Action::SaveNotes => return Some(self.save_notes()),
            Action::LeaveEditor => self.editing = false,
            _ => return None,
        }
        Some(Vec::new())
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        if area.width < 60 || area.height < 14 {
            return draw_stack(self, self.panes(), canvas, area, context);
        }
        let few = context.company.forecast_scores.len() as u16 + 4;
        let wide = area.width >= 104;
        let [list, below] = if wide {
            let right = (area.width / 3).clamp(48, 64);
            Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area)
        } else {
            Layout::vertical([Constraint::Min(0), Constraint::Length(few)]).areas(area)
        };
        let (list, below) = self.draw_tree(canvas, (list, below), area, context);
        draw_pane(self, JournalPane::List, canvas, list, context);
        let [scores, notes] = if wide {
            // Individual forecasts are shown below the scores if there is space.
            let tall = (few + 9).min(below.height / 2).max(few);
            Layout::vertical([Constraint::Length(tall), Constraint::Min(0)]).areas(below)
        } else {
            Layout::horizontal([Constraint::Length(40), Constraint::Min(0)]).areas(below)
        };
        draw_pane(self, JournalPane::Scores, canvas, scores, context);
        draw_pane(self, JournalPane::Notes, canvas, notes, context);
    }
}

/// Minimum height of the screen for showing the tree together with all other panes.
const MIN_HEIGHT_FOR_TREE: u16 = 26;

impl Journal {
    /// Draws the tree of related runs below the list, if there is a tree. In small windows, the tree
    /// shares the area of the list. Returns the areas for the list and the other panes.
    fn draw_tree(
        &self,
        canvas: &mut Canvas<'_>,
        (list, below): (Rect, Rect),
        area: Rect,
        context: &ScreenContext<'_>,
    ) -> (Rect, Rect) {
        if !self.has_tree() {
            return (list, below);
        }
        if area.height < MIN_HEIGHT_FOR_TREE {
            draw_stack(self, &[JournalPane::List, JournalPane::Branches], canvas, list, context);
            return (Rect::default(), below);
        }
        let wanted = self.tree.len() as u16 + branches::CHROME_ROWS + 3;
        let tall = wanted.min(list.height / 2);
        let [list, tree] = Layout::vertical([Constraint::Min(0), Constraint::Length(tall)]).areas(list);
        draw_pane(self, JournalPane::Branches, canvas, tree, context);
        (list, below)
    }
}
