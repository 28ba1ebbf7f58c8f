//! Tree of tables and columns next to the editor.

use std::collections::BTreeSet;

use ratatui::layout::Rect;

use crate::action::Action;
use crate::screens::panes::PanePlacement;
use novamind_database::{Column, Interface, Table, hidden_tables, tables};
use novamind_tui::canvas::{Align, Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;

/// Label of x-ray tables in the tree.
const XRAY_LABEL: &str = "x-ray";

/// Returns the table with an index. The indexes of x-ray tables follow the indexes of public tables.
fn table_at(interface: Interface, at: usize) -> &'static Table {
    let visible = tables(interface);
    visible.get(at).unwrap_or_else(|| &hidden_tables()[at - visible.len()])
}

/// The tree of tables and columns, with its selection and filter.
#[derive(Debug, Default)]
pub struct TableBrowser {
    /// Release whose tables are shown.
    pub interface: Interface,
    /// Whether x-ray tables are shown below the public tables.
    pub shows_hidden: bool,
    open: BTreeSet<usize>,
    selected: usize,
    filter: String,
    filter_field: Option<TextField>,
}

/// A row of the tree: a table or one of its columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BrowserRow {
    interface: Interface,
    table: usize,
    column: Option<usize>,
}

impl BrowserRow {
    pub fn table(self) -> &'static Table {
        table_at(self.interface, self.table)
    }

    pub fn column(self) -> Option<&'static Column> {
        self.column.map(|at| &self.table().columns[at])
    }

    pub fn name(self) -> &'static str {
        self.column().map_or(&self.table().name, |column| &column.name)
    }
}

impl TableBrowser {
    /// Returns the visible rows of the tree.
    fn visible_rows(&self) -> Vec<BrowserRow> {
        let wanted = self.filter.to_lowercase();
        let matches_filter = |name: &str| wanted.is_empty() || name.to_lowercase().contains(&wanted);
        let mut entries = Vec::new();
        let interface = self.interface;
        let count = tables(interface).len() + if self.shows_hidden { hidden_tables().len() } else { 0 };
        for (at, table) in (0..count).map(|at| (at, table_at(interface, at))) {
            let found = |column: usize| !wanted.is_empty() && matches_filter(&table.columns[column].name);
            let columns = (0..table.columns.len()).filter(|number| self.open.contains(&at) || found(*number));
            let columns: Vec<usize> = columns.collect();
            if matches_filter(&table.name) || !columns.is_empty() {
                entries.push(BrowserRow { interface, table: at, column: None });
                entries.extend(columns.into_iter().map(|column| BrowserRow { interface, table: at, column: Some(column) }));
            }
        }
        entries
    }

    pub fn selected(&self) -> Option<BrowserRow> {
        self.visible_rows().get(self.selected).copied()
    }

    /// Returns the name of the selected table if it is expanded.
    pub fn open_table(&self) -> Option<&'static str> {
        let row = self.selected().filter(|row| self.open.contains(&row.table))?;
        Some(&row.table().name)
    }

    /// Selects a visible row. Returns whether the row was already selected.
    pub fn select(&mut self, row: usize) -> bool {
        let again = self.selected == row;
        self.selected = row.min(self.visible_rows().len().saturating_sub(1));
        again
    }

    /// Returns whether a filter is set or being typed.
    pub fn is_filtered(&self) -> bool {
        self.is_filter_open() || !self.filter.is_empty()
    }

    pub fn is_filter_open(&self) -> bool {
        self.filter_field.is_some()
    }

    pub fn edit_filter_text(&mut self, edit: &mut dyn FnMut(&mut TextField)) {
        if let Some(field) = &mut self.filter_field {
            edit(field);
            self.filter = field.text().to_owned();
            self.clamp_selection();
        }
    }

    /// Returns the filter text to show in the border.
    pub fn filter_text(&self) -> String {
        if self.filter.is_empty() { String::new() } else { format!("\"{}\"", self.filter) }
    }

    fn clamp_selection(&mut self) {
        self.selected = self.selected.min(self.visible_rows().len().saturating_sub(1));
    }

    fn set_expanded(&mut self, open: bool) {
        let Some(entry) = self.selected() else { return };
        if open {
            self.open.insert(entry.table);
        } else {
            self.open.remove(&entry.table);
            let head = BrowserRow { column: None, ..entry };
            self.selected = self.visible_rows().iter().position(|browser_row| *browser_row == head).unwrap_or(0);
        }
    }

    /// Handles actions that move, expand, collapse or filter. Returns false for other actions.
    pub fn handle_action(&mut self, action: Action, page: u16) -> bool {
        let last = self.visible_rows().len().saturating_sub(1);
        match action {
            Action::Up => self.selected = self.selected.saturating_sub(1),
            Action::Down => self.selected = (self.selected + 1).min(last),
            Action::PageUp => self.selected = self.selected.saturating_sub(page.max(1) as usize),
            Action::PageDown => self.selected = (self.selected + page.max(1) as usize).min(last),
            Action::First => self.selected = 0,
            Action::Last => self.selected = last,
            Action::Left => self.set_expanded(false),
            Action::Right => self.set_expanded(true),
            Action::Filter => self.filter_field = Some(TextField::with_text(self.filter.clone())),
            Action::Commit | Action::CommitDown | Action::CommitNext | Action::CommitPrevious => {
                self.filter_field = None;
            }
            Action::Discard | Action::Close if self.filter_field.is_some() || !self.filter.is_empty() => {
                self.filter_field = None;
                self.filter.clear();
                self.clamp_selection();
            }
            _ => return false,
        }
        true
    }

    /// Draws the tree, and a description of the selected row below the tree.
    pub fn draw(&self, canvas: &mut Canvas<'_>, placement: PanePlacement) {
        let (inside, focused) = (placement.area, placement.focused);
        if inside.is_empty() {
            return;
        }
        let entries = self.visible_rows();
        let words = if focused { self.description_lines(inside.width as usize) } else { Vec::new() };
        let below = (words.len() as u16).min(inside.height / 3);
        let filter_row = u16::from(self.filter_field.is_some());
        let height = inside.height.saturating_sub(below + filter_row);
        let tree = Rect { height, ..inside };
        if focused {
            canvas.page_rows = height.max(1);
        }
        if entries.is_empty() {
            canvas.draw_text(tree, "No match", Role::Dim);
        }
        let from = canvas.scroll_to_row(Rect { height, ..tree }, self.selected, entries.len());
        for (row, (at, entry)) in row_rects(tree).zip(entries.iter().enumerate().skip(from)) {
            self.draw_entry(canvas, row, *entry, (at == self.selected).then_some(focused));
            canvas.register_click(row, Click::Row(placement.index, at));
        }
        let under = Rect { y: tree.bottom(), height: below, ..inside };
        for (row, line) in row_rects(under).zip(&words) {
            canvas.draw_text(row, line, Role::Dim);
        }
        if let Some(field) = &self.filter_field {
            let row = Rect { y: inside.bottom() - 1, height: 1, ..inside };
            canvas.draw_text(row, "/", Role::Key);
            field.draw(canvas, Rect { x: row.x + 1, width: row.width - 1, ..row });
        }
    }

    fn draw_entry(&self, canvas: &mut Canvas<'_>, row: Rect, entry: BrowserRow, selected: Option<bool>) {
        let over = selected.map(|focused| if focused { Role::Selection } else { Role::InactiveSelection });
        if let Some(role) = over {
            canvas.clear(row, role);
        }
        match entry.column() {
            None => {
                let mark = if self.open.contains(&entry.table) { "▾" } else { "▸" };
                canvas.draw_text(row, &format!("{mark} {}", entry.name()), over.unwrap_or(Role::Strong));
                let taken = entry.name().len() as u16 + 2;
                if entry.table >= tables(self.interface).len() && row.width > taken + XRAY_LABEL.len() as u16 {
                    canvas.draw_aligned(row, XRAY_LABEL, over.unwrap_or(Role::Warning), Align::Right);
                }
            }
            Some(column) => {
                let kind = column.kind.as_str();
                let room = row.width.saturating_sub(kind.len() as u16 + 1);
                canvas.draw_text(
                    Rect { width: room, ..row },
                    &format!("    {}", column.name),
                    over.unwrap_or(Role::Text),
                );
                if room > 12 {
                    canvas.draw_aligned(row, kind, over.unwrap_or(Role::Dim), Align::Right);
                }
            }
        }
    }

    fn description_lines(&self, width: usize) -> Vec<String> {
        let Some(entry) = self.selected() else { return Vec::new() };
        let mut text = match entry.column() {
            Some(column) => column.description.clone(),
            None => entry.table().description.clone(),
        };
        if let Some(column) = entry.column().filter(|column| !column.values.is_empty()) {
            text += &format!(": {}", column.values.join(", "));
        }
        let mut lines = vec!["─".repeat(width)];
        lines.extend(wrap(&text, width));
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_expand_and_collapse() {
        let mut browser = TableBrowser::default();
        assert_eq!(browser.visible_rows().len(), 19);
        browser.handle_action(Action::Right, 5);
        assert_eq!(browser.visible_rows().len(), 19 + tables(Interface::Release1)[0].columns.len());
        browser.handle_action(Action::Down, 5);
        assert_eq!(browser.selected().map(BrowserRow::name), Some("customer_id"));
        browser.handle_action(Action::Left, 5);
        assert_eq!(
            (browser.visible_rows().len(), browser.selected().map(BrowserRow::name)),
            (19, Some("customers"))
        );
    }

    #[test]
    fn filter_finds_columns_of_collapsed_tables() {
        let mut browser = TableBrowser::default();
        browser.handle_action(Action::Last, 5);
        browser.handle_action(Action::Filter, 5);
        browser.edit_filter_text(&mut |field| field.insert("amount"));
        let names: Vec<&str> = browser.visible_rows().into_iter().map(BrowserRow::name).collect();
        assert!(names.contains(&"ledger") && names.contains(&"amount"), "{names:?}");
        assert!(browser.selected().is_some());
        browser.handle_action(Action::Discard, 5);
        assert_eq!(browser.visible_rows().len(), 19);
        browser.filter = "zzz".to_owned();
        browser.clamp_selection();
        assert_eq!(browser.selected(), None);
        assert!(browser.handle_action(Action::Right, 5));
    }
}
