//! Tree of related runs: where each branched off, its first change and its state.

use ratatui::layout::Rect;

use super::{Journal, JournalPane};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::short_dollars;
use novamind_insight::Kin;
use novamind_report::first_change_in_words;
use novamind_report::whatif::kin_line;
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, Table};
use novamind_worker::company::Company;
use novamind_worker::questions::RelatedRunsQuestion;

pub struct BranchesPane;

/// Rows of the pane besides the runs: border and headings.
pub const AROUND: u16 = 3;
/// Height from which the selected run is described below the table.
const TOLD_FROM: u16 = 7;

pub fn table() -> Table {
    Table::new(vec![
        Column::words("run"),
        Column::numbers("branch at").at_least(7),
        Column::words("first change").at_least(12),
        Column::numbers("day"),
        Column::numbers("cash"),
        Column::words("end"),
    ])
}

/// Returns the rows of a tree, with the current run marked.
pub fn rows(tree: &[Kin], own: &str) -> Vec<Vec<Cell>> {
    tree.iter().map(|kin| row(kin, own)).collect()
}

fn row(kin: &Kin, own: &str) -> Vec<Cell> {
    let run = &kin.run;
    let (mark, role) = if run.id == own { (" ◂", Role::Strong) } else { ("", Role::Text) };
    let left = match kin.left_in_week {
        Some(week) => Cell::number(week.into(), format!("week {week}")),
        None => Cell::words(""),
    };
    let change = match (&kin.first_change, kin.left_in_week) {
        (Some(change), Some(_)) => Cell::words(first_change_in_words(change)),
        (None, Some(_)) => Cell::words("none").role(Role::Dim),
        (_, None) => Cell::words(""),
    };
    vec![
        Cell::words(format!("{}{}{mark}", "  ".repeat(kin.depth), run.id)).role(role),
        left,
        change,
        Cell::number(run.day.into(), format!("{} of {}", run.day, run.days)),
        Cell::number(run.cash, short_dollars(run.cash)),
        Cell::words(run.ended.map_or("", |ended| ended.id())).role(Role::Dim),
    ]
}

impl Journal {
    /// Returns whether the run is a branch or has branches.
    pub(super) fn has_tree(&self) -> bool {
        self.tree.len() > 1
    }

    /// Requests the tree, unless it is being read or cannot have changed.
    pub(super) fn ask_tree(&mut self, company: &Company) -> Vec<Effect> {
        let is_known = company.replayed && self.is_tree_read;
        if company.study.is_some() || company.folder.is_none() || self.asked.is_waiting() || is_known {
            return Vec::new();
        }
        vec![Effect::Ask(self.asked.ask(RelatedRunsQuestion))]
    }

    pub(super) fn take_tree(&mut self, tree: Vec<Kin>, company: &Company) {
        let run = &company.seen.run;
        let is_first = self.tree.is_empty();
        (self.tree, self.is_tree_read) = (tree, true);
        self.branches.set_rows(rows(&self.tree, run));
        if is_first && let Some(own) = self.tree.iter().position(|kin| kin.run.id == *run) {
            self.branches.select(own);
        }
        if self.focus == JournalPane::Branches && !self.has_tree() {
            self.focus = JournalPane::List;
        }
    }

    /// Returns the note next to the title of the entries: the filter, or the number of runs in the tree with
    /// its key.
    pub(super) fn note(&self, look: &Look<'_>) -> String {
        match (self.table.note(), self.has_tree()) {
            (note, false) => note,
            (note, true) if !note.is_empty() => note,
            (_, true) => format!("{} of {} runs", look.hint(Action::ShowTree), self.tree.len()),
        }
    }

    fn selected_kin(&self) -> Option<&Kin> {
        self.branches.selected().and_then(|row| self.tree.get(row))
    }
}

impl Pane<Journal> for BranchesPane {
    fn table<'a>(&self, journal: &'a Journal) -> Option<&'a Table> {
        Some(&journal.branches)
    }

    fn table_mut<'a>(&self, journal: &'a mut Journal) -> Option<&'a mut Table> {
        Some(&mut journal.branches)
    }

    fn scopes(&self, journal: &Journal) -> Vec<Scope> {
        if journal.branches.is_typing() { vec![Scope::Field, Scope::List] } else { vec![Scope::List] }
    }

    fn hints(&self, _: &Journal) -> Vec<Action> {
        vec![Action::Open, Action::Filter, Action::Close]
    }

    fn figure(&self, journal: &Journal, _: &Look<'_>) -> Option<Figure> {
        let title = journal.selected_kin().map(|kin| format!("run {}", kin.run.id))?;
        Some(Figure { title, term: "branch", sql: None, why: None })
    }

    fn act(&self, journal: &mut Journal, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let is_filtered = journal.branches.is_filtered();
        match action {
            Action::Open => {
                return match journal.selected_kin() {
                    Some(kin) => vec![Effect::OpenRun(kin.run.id.clone())],
                    None => Vec::new(),
                };
            }
            Action::Close if !is_filtered => journal.focus = JournalPane::List,
            action => drop(journal.branches.act(action, look.page)),
        }
        Vec::new()
    }

    fn border(&self, journal: &Journal, _: Rect, look: &Look<'_>) -> Border {
        let open = look.keys.label(Action::Open).unwrap_or_default();
        Border {
            title: "Branches".to_owned(),
            note: journal.branches.note(),
            keys: format!("{open} opens the run"),
            ..Border::default()
        }
    }

    fn draw(&self, journal: &Journal, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let told = match journal.selected_kin() {
            Some(kin) => wrapped(kin_line(kin, &look.company.seen.run).trim_start(), seat.area.width.into()),
            None => Vec::new(),
        };
        let rows = journal.branches.shown().len() as u16 + 1;
        let below = match seat.area.height >= TOLD_FROM {
            true => (told.len() as u16 + 1).min(seat.area.height / 2),
            false => seat.area.height.saturating_sub(rows + 1).min(told.len() as u16 + 1),
        };
        let area = Rect { height: seat.area.height - below, ..seat.area };
        journal.branches.draw(canvas, area, seat.focused, seat.number);
        let below = Rect { y: area.bottom(), height: below, ..seat.area };
        for (row, line) in rows_of(below).skip(1).zip(&told) {
            canvas.text(row, line, Role::Dim);
        }
    }
}
