//! A table with a selection, sorting and a filter. Only visible rows are drawn.

use std::cmp::Ordering;

use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use unicode_width::UnicodeWidthStr;

use super::ListAction;
use super::field::TextField;
use crate::canvas::{Align, Canvas, Click, truncate_to_width};
use crate::theme::Role;

/// Minimum width of a truncated text column.
const MIN_TEXT_WIDTH: u16 = 8;

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableColumn {
    /// Heading of the column.
    pub title: String,
    /// Alignment of the heading and the cells.
    pub align: Align,
    /// Maximum width in cells of the terminal.
    pub max_width: u16,
    /// Width to which the column may shrink in favor of later columns.
    pub min_width: u16,
}

impl TableColumn {
    /// Returns a left-aligned column for text.
    pub fn text(title: impl Into<String>) -> TableColumn {
        TableColumn { title: title.into(), align: Align::Left, max_width: 40, min_width: u16::MAX }
    }

    /// Returns a right-aligned column for numbers.
    pub fn numeric(title: impl Into<String>) -> TableColumn {
        TableColumn { title: title.into(), align: Align::Right, max_width: 24, min_width: u16::MAX }
    }

    /// Sets the maximum width of the column.
    pub fn with_max_width(self, most: u16) -> TableColumn {
        TableColumn { max_width: most, ..self }
    }

    /// Sets the width to which the column may shrink if later columns need the space.
    pub fn with_min_width(self, least: u16) -> TableColumn {
        TableColumn { min_width: least, ..self }
    }
}

/// A cell of a table: the displayed text and the sort key.
#[derive(Debug, Clone, PartialEq)]
pub struct TableCell {
    /// Displayed text of the cell.
    pub text: String,
    /// Sort key of the cell if the cell is a number.
    pub number: Option<f64>,
    /// Role that determines the style of the cell.
    pub role: Role,
}

impl TableCell {
    /// Returns a cell with a text.
    pub fn from_text(text: impl Into<String>) -> TableCell {
        TableCell { text: text.into(), number: None, role: Role::Text }
    }

    /// Returns a cell with a number and its formatted value.
    pub fn from_number(value: f64, shown: impl Into<String>) -> TableCell {
        TableCell { text: shown.into(), number: Some(value), role: Role::Text }
    }

    /// Sets the role of the cell.
    pub fn with_role(self, role: Role) -> TableCell {
        TableCell { role, ..self }
    }
}

/// A table with its selection, sort order and filter.
#[derive(Debug, Clone, Default)]
pub struct Table {
    columns: Vec<TableColumn>,
    rows: Vec<Vec<TableCell>>,
    /// Indexes of the displayed rows, filtered and sorted.
    visible_rows: Vec<usize>,
    widths: Vec<u16>,
    /// Position of the selected row among the displayed rows.
    selected: usize,
    column: usize,
    sort_order: Option<(usize, Ordering)>,
    filter: String,
    filter_field: Option<TextField>,
    selects_cells: bool,
}

impl Table {
    /// Returns a table without rows.
    pub fn new(columns: Vec<TableColumn>) -> Table {
        let mut table = Table { columns, ..Table::default() };
        table.measure_columns();
        table
    }

    /// Enables the selection of a single cell in the selected row.
    pub fn with_cell_selection(self) -> Table {
        Table { selects_cells: true, ..self }
    }

    /// Replaces the columns and rows. Keeps the selection, the sort order and the filter if possible.
    pub fn set_columns_and_rows(&mut self, columns: Vec<TableColumn>, rows: Vec<Vec<TableCell>>) {
        if columns.len() != self.columns.len() {
            self.sort_order = None;
        }
        self.columns = columns;
        self.set_rows(rows);
        self.column = self.column.min(self.columns.len().saturating_sub(1));
    }

    /// Replaces the rows of the table.
    pub fn set_rows(&mut self, rows: Vec<Vec<TableCell>>) {
        self.rows = rows;
        self.measure_columns();
        self.update_visible_rows();
    }

    /// Returns all rows in their original order.
    pub fn rows(&self) -> &[Vec<TableCell>] {
        &self.rows
    }

    /// Returns the index of the selected row in the list of all rows.
    pub fn selected(&self) -> Option<usize> {
        self.visible_rows.get(self.selected).copied()
    }

    /// Returns the indexes of the displayed rows in display order.
    pub fn visible_rows(&self) -> &[usize] {
        &self.visible_rows
    }

    /// Returns the index of the selected column.
    pub fn selected_column(&self) -> usize {
        self.column
    }

    /// Selects a column. If the index is too high, selects the last column.
    pub fn select_column(&mut self, column: usize) {
        self.column = column.min(self.columns.len().saturating_sub(1));
    }

    /// Selects a row by its index in the list of all rows.
    pub fn select(&mut self, row: usize) {
        if let Some(place) = self.visible_rows.iter().position(|shown| *shown == row) {
            self.selected = place;
        }
    }

    /// Selects a row by its position among the displayed rows, as a click does.
    pub fn select_visible_row(&mut self, place: usize) {
        self.selected = place.min(self.visible_rows.len().saturating_sub(1));
    }

    /// Returns whether the user is typing a filter.
    pub fn is_filter_open(&self) -> bool {
        self.filter_field.is_some()
    }

    /// Returns whether a filter is set or the user is typing one.
    pub fn is_filtered(&self) -> bool {
        self.is_filter_open() || !self.filter.is_empty()
    }

    /// Returns the text of the filter, or an empty text if there is no filter.
    pub fn filter_text(&self) -> &str {
        &self.filter
    }

    /// Returns the field in which the user types the filter, if it is open.
    pub fn filter_field(&mut self) -> Option<&mut TextField> {
        self.filter_field.as_mut()
    }

    /// Edits the text in the filter field and applies the filter.
    pub fn edit_filter(&mut self, edit: impl FnOnce(&mut TextField)) {
        if let Some(field) = &mut self.filter_field {
            edit(field);
            self.apply_filter();
        }
    }

    /// Applies the text in the filter field as the filter.
    pub fn apply_filter(&mut self) {
        if let Some(field) = &self.filter_field {
            self.filter = field.text().to_owned();
            self.update_visible_rows();
        }
    }

    /// Describes the number of displayed rows, the filter and the sort order, for the note of a pane.
    pub fn summary(&self) -> String {
        let mut parts = Vec::new();
        if !self.filter.is_empty() {
            parts.push(format!(
                "{} of {} with \"{}\"",
                self.visible_rows.len(),
                self.rows.len(),
                self.filter
            ));
        }
        if let Some((column, order)) = self.sort_order {
            let arrow = if order == Ordering::Less { "▲" } else { "▼" };
            let title = self.columns.get(column).map_or("", |column| column.title.as_str());
            parts.push(format!("by {title} {arrow}"));
        }
        parts.join(" · ")
    }

    /// Handles a list action. Returns false if the table does not support the action.
    pub fn handle_action(&mut self, action: impl Into<Option<ListAction>>, page: u16) -> bool {
        let Some(action) = action.into() else { return false };
        let last = self.visible_rows.len().saturating_sub(1);
        match action {
            ListAction::Up => self.selected = self.selected.saturating_sub(1),
            ListAction::Down => self.selected = (self.selected + 1).min(last),
            ListAction::PageUp => self.selected = self.selected.saturating_sub(page.max(1) as usize),
            ListAction::PageDown => self.selected = (self.selected + page.max(1) as usize).min(last),
            ListAction::First => self.selected = 0,
            ListAction::Last => self.selected = last,
            ListAction::Left => self.column = self.column.saturating_sub(1),
            ListAction::Right => self.column = (self.column + 1).min(self.columns.len().saturating_sub(1)),
            ListAction::Sort => self.sort(),
            ListAction::Filter => self.filter_field = Some(TextField::with_text(self.filter.clone())),
            ListAction::Commit if self.filter_field.is_some() => self.filter_field = None,
            ListAction::Discard if self.filter_field.is_some() => {
                self.filter_field = None;
                self.filter.clear();
                self.update_visible_rows();
            }
            ListAction::Close if !self.filter.is_empty() => {
                self.filter.clear();
                self.update_visible_rows();
            }
            _ => return false,
        }
        true
    }

    fn sort(&mut self) {
        let numeric =
            self.rows.iter().any(|row| row.get(self.column).is_some_and(|cell| cell.number.is_some()));
        // The first sort order of numbers is descending, the first sort order of text is ascending.
        let first = if numeric { Ordering::Greater } else { Ordering::Less };
        self.sort_order = match self.sort_order {
            Some((column, order)) if column == self.column && order == first => {
                Some((column, order.reverse()))
            }
            Some((column, _)) if column == self.column => None,
            _ => Some((self.column, first)),
        };
        self.update_visible_rows();
        self.selected = 0;
    }

    fn update_visible_rows(&mut self) {
        let kept = self.selected();
        let wanted = self.filter.to_lowercase();
        let holds = |row: &Vec<TableCell>| row.iter().any(|cell| cell.text.to_lowercase().contains(&wanted));
        self.visible_rows =
            (0..self.rows.len()).filter(|at| wanted.is_empty() || holds(&self.rows[*at])).collect();
        if let Some((column, order)) = self.sort_order {
            let rows = &self.rows;
            self.visible_rows.sort_by(|left, right| {
                let natural = compare_cells(rows[*left].get(column), rows[*right].get(column));
                if order == Ordering::Less { natural } else { natural.reverse() }
            });
        }
        match kept.and_then(|kept| self.visible_rows.iter().position(|shown| *shown == kept)) {
            Some(place) => self.selected = place,
            None => self.selected = self.selected.min(self.visible_rows.len().saturating_sub(1)),
        }
    }

    fn measure_columns(&mut self) {
        let width = |at: usize, column: &TableColumn| {
            let cells = self.rows.iter().filter_map(|row| row.get(at)).map(|cell| cell.text.width());
            cells.max().unwrap_or(0).max(column.title.width()).clamp(1, column.max_width as usize) as u16
        };
        self.widths = self.columns.iter().enumerate().map(|(at, column)| width(at, column)).collect();
    }

    /// Draws the column headings and the rows. Clicks are registered with `pane` as the number of the pane.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, focused: bool, pane: usize) {
        if area.height < 2 || area.width < 2 {
            return;
        }
        let filter_row = u16::from(self.filter_field.is_some());
        let height = area.height - 1 - filter_row;
        if focused {
            canvas.page_rows = height.max(1);
        }
        let columns = self.visible_columns(area.width);
        let head = Rect { height: 1, ..area };
        for (at, place) in &columns {
            let column = &self.columns[*at];
            let cell = Rect { x: head.x + place.0, width: place.1, ..head };
            let role = if focused && *at == self.column { Role::Title } else { Role::Header };
            canvas.draw_aligned(cell, &column.title, role, column.align);
        }
        // Signs show that further columns are to the left or to the right.
        if let [_, (second, (x, _)), ..] = columns[..]
            && second > 1
        {
            canvas.draw_text(Rect { x: head.x + x - 1, width: 1, ..head }, "‹", Role::Key);
        }
        if let Some((last, (x, width))) = columns.last()
            && last + 1 < self.columns.len()
            && x + width < area.width
        {
            canvas.draw_text(Rect { x: area.right() - 1, width: 1, ..head }, "›", Role::Key);
        }
        let from = first_visible_row(self.selected, height as usize, self.visible_rows.len());
        for (line, row) in self.visible_rows.iter().enumerate().skip(from).take(height as usize) {
            let y = area.y + 1 + (line - from) as u16;
            let whole = Rect { x: area.x, y, width: area.width, height: 1 };
            self.draw_row(canvas, whole, *row, &columns, (line == self.selected).then_some(focused));
            canvas.register_click(whole, Click::Row(pane, line));
        }
        if let Some(field) = &self.filter_field {
            let row = Rect { y: area.bottom() - 1, height: 1, ..area };
            canvas.draw_text(row, "/", Role::Key);
            field.draw(canvas, Rect { x: row.x + 1, width: row.width - 1, ..row });
        }
    }

    fn draw_row(
        &self,
        canvas: &mut Canvas<'_>,
        whole: Rect,
        row: usize,
        columns: &[(usize, (u16, u16))],
        selected: Option<bool>,
    ) {
        let over = selected.map(|focused| if focused { Role::Selection } else { Role::InactiveSelection });
        if let Some(role) = over {
            let style = canvas.style(role);
            canvas.buffer.set_style(whole.intersection(canvas.buffer.area), style);
        }
        for (at, (x, width)) in columns {
            let Some(cell) = self.rows[row].get(*at) else { continue };
            let place = Rect { x: whole.x + x, width: *width, ..whole };
            let text = truncate_to_width(&cell.text, *width as usize);
            canvas.draw_aligned(place, &text, over.unwrap_or(cell.role), self.columns[*at].align);
            if self.selects_cells && selected == Some(true) && *at == self.column {
                let mark = Style::new().add_modifier(Modifier::BOLD | Modifier::UNDERLINED);
                canvas.buffer.set_style(place.intersection(canvas.buffer.area), mark);
            }
        }
    }

    /// Returns the widths of the columns after they are shrunk to fit into a width.
    fn fit_widths(&self, width: u16) -> Vec<u16> {
        let all: usize = self.widths.iter().map(|number| usize::from(*number) + 2).sum();
        let mut missing = all.saturating_sub(usize::from(width) + 2).min(usize::from(u16::MAX)) as u16;
        let fitted = |(natural_width, column): (&u16, &TableColumn)| {
            let given = natural_width.saturating_sub(column.min_width).min(missing);
            missing -= given;
            natural_width - given
        };
        self.widths.iter().zip(&self.columns).map(fitted).collect()
    }

    fn visible_columns(&self, width: u16) -> Vec<(usize, (u16, u16))> {
        let widths = self.fit_widths(width);
        let mut from = 1;
        loop {
            let mut x = 0;
            let mut columns = Vec::new();
            let order = std::iter::once(0).chain(from..self.columns.len());
            for at in order.filter(|at| *at < self.columns.len()) {
                let number = widths[at];
                // A truncated column must be wide enough for readable text.
                let room = width.saturating_sub(x);
                let readable = match self.columns[at].align {
                    Align::Right => number,
                    _ => number.min(MIN_TEXT_WIDTH),
                };
                if room == 0 || (x > 0 && room < readable) {
                    break;
                }
                columns.push((at, (x, number.min(width - x))));
                x += number + 2;
            }
            let whole = |(at, (_, shown)): &(usize, (u16, u16))| *at == self.column && *shown == widths[*at];
            if self.column < from
                || columns.iter().any(whole)
                || from >= self.columns.len()
                || from >= self.column
            {
                return columns;
            }
            from += 1;
        }
    }
}

/// Returns the first visible row for which the selected row is near the middle.
pub fn first_visible_row(selected: usize, height: usize, rows: usize) -> usize {
    selected.saturating_sub(height / 2).min(rows.saturating_sub(height))
}

fn compare_cells(left: Option<&TableCell>, right: Option<&TableCell>) -> Ordering {
    let key = |cell: Option<&TableCell>| cell.and_then(|cell| cell.number);
    match (key(left), key(right)) {
        (Some(left), Some(right)) => left.total_cmp(&right),
        (Some(_), None) => Ordering::Greater,
        (None, Some(_)) => Ordering::Less,
        (None, None) => {
            let text = |cell: Option<&TableCell>| cell.map(|cell| cell.text.to_lowercase());
            text(left).cmp(&text(right))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new(vec![TableColumn::text("name"), TableColumn::numeric("size")]);
        let row = |name: &str, size: f64| {
            vec![TableCell::from_text(name), TableCell::from_number(size, size.to_string())]
        };
        table.set_rows(vec![row("Beta", 2.0), row("alpha", 10.0), row("gamma", 1.0)]);
        table
    }

    fn names(table: &Table) -> Vec<&str> {
        table.visible_rows.iter().map(|row| table.rows[*row][0].text.as_str()).collect()
    }

    #[test]
    fn sort_cycles_through_ascending_descending_and_off() {
        let mut table = table();
        table.handle_action(ListAction::Sort, 5);
        assert_eq!(names(&table), ["alpha", "Beta", "gamma"]);
        table.handle_action(ListAction::Right, 5);
        table.handle_action(ListAction::Sort, 5);
        assert_eq!(names(&table), ["alpha", "Beta", "gamma"], "largest first");
        table.handle_action(ListAction::Sort, 5);
        assert_eq!(names(&table), ["gamma", "Beta", "alpha"]);
        table.handle_action(ListAction::Sort, 5);
        assert_eq!(names(&table), ["Beta", "alpha", "gamma"]);
    }

    #[test]
    fn filter_keeps_the_selected_row_if_visible() {
        let mut table = table();
        table.handle_action(ListAction::Last, 5);
        table.handle_action(ListAction::Filter, 5);
        table.filter_field().expect("typing").insert("A");
        table.apply_filter();
        assert_eq!((names(&table), table.selected()), (vec!["Beta", "alpha", "gamma"], Some(2)));
        table.filter_field().expect("typing").insert("m");
        table.apply_filter();
        assert_eq!((names(&table), table.selected()), (vec!["gamma"], Some(2)));
        table.handle_action(ListAction::Discard, 5);
        assert_eq!((table.visible_rows.len(), table.selected()), (3, Some(2)));
    }

    #[test]
    fn empty_table_has_no_selection() {
        let mut table = Table::new(vec![TableColumn::text("name")]);
        for action in
            [ListAction::Down, ListAction::PageDown, ListAction::Last, ListAction::Sort, ListAction::Right]
        {
            table.handle_action(action, 3);
        }
        assert_eq!(table.selected(), None);
        assert_eq!(first_visible_row(5, 4, 20), 3);
        assert_eq!(first_visible_row(19, 4, 20), 16);
        assert_eq!(first_visible_row(0, 4, 2), 0);
    }
}
