//! Tree of related runs, with the branch point, the first change and the state of each run.

use ratatui::layout::Rect;

use super::{Journal, JournalPane};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::short_dollars;
use novamind_insight::RelatedRun;
use novamind_report::describe_first_change;
use novamind_report::whatif::related_run_line;
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn, Table};
use novamind_worker::company::DisplayedCompany;
use novamind_worker::page_questions::RelatedRunsQuestion;

pub struct BranchesPane;

/// Number of rows of the pane that do not show runs: the border and the headings.
pub const CHROME_ROWS: u16 = 3;
/// Minimum height of the pane for a description of the selected run below the table.
const MIN_HEIGHT_FOR_DETAILS: u16 = 7;

pub fn empty_table() -> Table {
    Table::new(vec![
        TableColumn::text("run"),
        TableColumn::numeric("branch at").with_min_width(7),
        TableColumn::text("first change").with_min_width(12),
        TableColumn::numeric("day"),
        TableColumn::numeric("cash"),
        TableColumn::text("end"),
    ])
}

/// Returns the table rows of a tree of related runs. The current run is marked.
pub fn tree_rows(tree: &[RelatedRun], text: &str) -> Vec<Vec<TableCell>> {
    tree.iter().map(|run| tree_row(run, text)).collect()
}

fn tree_row(related_run: &RelatedRun, text: &str) -> Vec<TableCell> {
    let run = &related_run.run;
    let (mark, role) = if run.id == text { (" ◂", Role::Strong) } else { ("", Role::Text) };
    let left = match related_run.branched_in_week {
        Some(week) => TableCell::from_number(week.into(), format!("week {week}")),
        None => TableCell::from_text(""),
    };
    let change = match (&related_run.first_change, related_run.branched_in_week) {
        (Some(change), Some(_)) => TableCell::from_text(describe_first_change(change)),
        (None, Some(_)) => TableCell::from_text("none").with_role(Role::Dim),
        (_, None) => TableCell::from_text(""),
    };
    vec![
        TableCell::from_text(format!("{}{}{mark}", "  ".repeat(related_run.depth), run.id)).with_role(role),
        left,
        change,
        TableCell::from_number(run.day.into(), format!("{} of {}", run.day, run.days)),
        TableCell::from_number(run.cash, short_dollars(run.cash)),
        TableCell::from_text(run.ended.map_or("", |ended| ended.id())).with_role(Role::Dim),
    ]
}

impl Journal {
    /// Returns whether the run is a branch or has branches.
    pub(super) fn has_tree(&self) -> bool {
        self.tree.len() > 1
    }

    /// Requests the tree of related runs, unless the tree is being read, cannot have changed or does not exist.
    pub(super) fn request_tree(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        let is_known = company.is_playback && self.is_tree_read;
        if company.study.is_some() || company.folder.is_none() || self.asked.is_waiting() || is_known {
            return Vec::new();
        }
        vec![Effect::Ask(self.asked.ask(RelatedRunsQuestion))]
    }

    pub(super) fn set_tree(&mut self, tree: Vec<RelatedRun>, company: &DisplayedCompany) {
        let run = &company.observation.run;
        let is_first = self.tree.is_empty();
        (self.tree, self.is_tree_read) = (tree, true);
        self.branches.set_rows(tree_rows(&self.tree, run));
        if is_first && let Some(number) = self.tree.iter().position(|related_run| related_run.run.id == *run) {
            self.branches.select(number);
        }
        if self.focus == JournalPane::Branches && !self.has_tree() {
            self.focus = JournalPane::List;
        }
    }

    /// Returns the note next to the title of the entries: the filter, or the number of related runs and the key that
    /// shows them.
    pub(super) fn entries_note(&self, context: &ScreenContext<'_>) -> String {
        match (self.table.summary(), self.has_tree()) {
            (note, false) => note,
            (note, true) if !note.is_empty() => note,
            (_, true) => format!("{} of {} runs", context.hint(Action::ShowTree), self.tree.len()),
        }
    }

    fn selected_run(&self) -> Option<&RelatedRun> {
        self.branches.selected().and_then(|row| self.tree.get(row))
    }
}

impl Pane<Journal> for BranchesPane {
    fn table<'a>(&self, journal: &'a Journal) -> Option<&'a Table> {
        Some(&journal.branches)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("journal.branches")
    }

    fn table_mut<'a>(&self, journal: &'a mut Journal) -> Option<&'a mut Table> {
        Some(&mut journal.branches)
    }

    fn scopes(&self, journal: &Journal) -> Vec<Scope> {
        if journal.branches.is_filter_open() { vec![Scope::Field, Scope::List] } else { vec![Scope::List] }
    }

    fn hints(&self, _: &Journal) -> Vec<Action> {
        vec![Action::Open, Action::Filter, Action::Close]
    }

    fn figure(&self, journal: &Journal, _: &ScreenContext<'_>) -> Option<Figure> {
        let title = journal.selected_run().map(|related_run| format!("run {}", related_run.run.id))?;
        Some(Figure { title, term: "branch", sql: None, week_quantity: None })
    }

    fn handle_action(&self, journal: &mut Journal, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let is_filtered = journal.branches.is_filtered();
        match action {
            Action::Open => {
                return match journal.selected_run() {
                    Some(run) => vec![Effect::OpenRun(run.run.id.clone())],
                    None => Vec::new(),
                };
            }
            Action::Close if !is_filtered => journal.focus = JournalPane::List,
            action => drop(journal.branches.handle_action(action, context.page_rows)),
        }
        Vec::new()
    }

    fn border(&self, journal: &Journal, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let open = context.keys.label(Action::Open).unwrap_or_default();
        PaneBorder {
            title: "Branches".to_owned(),
            note: journal.branches.summary(),
            keys: format!("{open} opens the run"),
            ..PaneBorder::default()
        }
    }

    fn draw(&self, journal: &Journal, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let texts = match journal.selected_run() {
            Some(run) => wrap(related_run_line(run, &context.company.observation.run).trim_start(), placement.area.width.into()),
            None => Vec::new(),
        };
        let rows = journal.branches.visible_rows().len() as u16 + 1;
        let below = match placement.area.height >= MIN_HEIGHT_FOR_DETAILS {
            true => (texts.len() as u16 + 1).min(placement.area.height / 2),
            false => placement.area.height.saturating_sub(rows + 1).min(texts.len() as u16 + 1),
        };
        let area = Rect { height: placement.area.height - below, ..placement.area };
        journal.branches.draw(canvas, area, placement.focused, placement.index);
        let below = Rect { y: area.bottom(), height: below, ..placement.area };
        for (row, line) in row_rects(below).skip(1).zip(&texts) {
            canvas.draw_text(row, line, Role::Dim);
        }
    }
}
