//! A table with a selection, sorting and a filter. Only visible rows are drawn.

use std::cmp::Ordering;

use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use unicode_width::UnicodeWidthStr;

use super::ListAction;
use super::column_layout::ColumnLayout;
use super::field::TextField;
use crate::canvas::{Align, Canvas, Click, truncate_to_width};
use crate::theme::Role;

/// Minimum width of a truncated text column.
const MIN_TEXT_WIDTH: u16 = 8;

/// Width reserved at the right end of the headings for the number of columns that do not fit: ` +12 →`.
const COLUMN_MARK_WIDTH: u16 = 6;

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableColumn {
    /// Heading of the column.
    pub title: String,
    /// Alignment of the heading and the cells.
    pub align: Align,
    /// Largest width of the column, in terminal cells.
    pub max_width: u16,
    /// Width to which the column may shrink if later columns need the space.
    pub min_width: u16,
    /// Whether the column is shown completely or not at all, because truncation would cut numbers in its texts.
    pub is_indivisible: bool,
}

impl TableColumn {
    /// Returns a left-aligned column for text.
    pub fn text(title: impl Into<String>) -> TableColumn {
        TableColumn {
            title: title.into(),
            align: Align::Left,
            max_width: 40,
            min_width: u16::MAX,
            is_indivisible: false,
        }
    }

    /// Returns a right-aligned column for numbers.
    pub fn numeric(title: impl Into<String>) -> TableColumn {
        TableColumn {
            title: title.into(),
            align: Align::Right,
            max_width: 24,
            min_width: u16::MAX,
            is_indivisible: true,
        }
    }

    /// Requires that the column is shown completely or not at all.
    pub fn indivisible(self) -> TableColumn {
        TableColumn { is_indivisible: true, ..self }
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
    /// Number by which the cell is sorted; `None` if it is sorted by its text.
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
    layout: ColumnLayout,
    /// Indexes of the columns that the layout shows, in display order.
    arranged: Vec<usize>,
    /// Position of the selected row among the displayed rows.
    selected: usize,
    /// Index of the selected column in the original order.
    column: usize,
    sort_order: Option<(usize, Ordering)>,
    filter: String,
    filter_field: Option<TextField>,
    selects_cells: bool,
    /// Number of columns, in addition to the first, that stay visible while the columns are scrolled.
    extra_pinned_columns: usize,
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

    /// Keeps the first `count` displayed columns visible while the columns are scrolled. The default is one column.
    pub fn set_pinned_columns(&mut self, count: usize) {
        self.extra_pinned_columns = count.saturating_sub(1);
    }

    /// Returns the columns of the table in their original order.
    pub fn columns(&self) -> &[TableColumn] {
        &self.columns
    }

    /// Returns the widths of the columns in their original order.
    pub fn widths(&self) -> &[u16] {
        &self.widths
    }

    /// Returns the layout of the columns that the user chose.
    pub fn layout(&self) -> &ColumnLayout {
        &self.layout
    }

    /// Changes the order, visibility and widths of the columns. If the selected column becomes hidden, selects the
    /// first column.
    pub fn set_layout(&mut self, layout: ColumnLayout) {
        self.layout = layout;
        self.measure_columns();
    }

    /// Replaces the columns and rows. Keeps the selection, the sort order and the filter if possible.
    pub fn set_columns_and_rows(&mut self, columns: Vec<TableColumn>, rows: Vec<Vec<TableCell>>) {
        if columns.len() != self.columns.len() {
            self.sort_order = None;
        }
        self.columns = columns;
        self.set_rows(rows);
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

    /// Returns the indexes of the columns that are not hidden, in display order.
    pub fn displayed_columns(&self) -> &[usize] {
        &self.arranged
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

    /// Handles a list action. Returns false if tables do not use the action.
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
            ListAction::Left => self.select_arranged_column(|place| place.saturating_sub(1)),
            ListAction::Right => self.select_arranged_column(|place| place + 1),
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

    /// Selects the column at position `change(p)` in display order, if `p` is the position of the selected column.
    fn select_arranged_column(&mut self, change: impl Fn(usize) -> usize) {
        let place = change(self.arranged_position()).min(self.arranged.len().saturating_sub(1));
        self.column = self.arranged.get(place).copied().unwrap_or(0);
    }

    /// Returns the position of the selected column in display order.
    fn arranged_position(&self) -> usize {
        self.arranged.iter().position(|at| *at == self.column).unwrap_or(0)
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
        let contains_filter =
            |row: &Vec<TableCell>| row.iter().any(|cell| cell.text.to_lowercase().contains(&wanted));
        self.visible_rows =
            (0..self.rows.len()).filter(|at| wanted.is_empty() || contains_filter(&self.rows[*at])).collect();
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
            let whole = cells.max().unwrap_or(0).max(column.title.width()).max(1);
            match (self.layout.fixed_width(&column.title), column.is_indivisible) {
                // A number is never truncated.
                (Some(width), true) => whole.max(usize::from(width)) as u16,
                (Some(width), false) => width,
                (None, _) => whole.min(column.max_width as usize) as u16,
            }
        };
        self.widths = self.columns.iter().enumerate().map(|(at, column)| width(at, column)).collect();
        self.arranged = self.layout.visible_columns(&self.columns);
        self.select_arranged_column(|place| place);
    }

    /// Draws the column headings and the rows. Registers clicks under the pane number `pane`.
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
        self.draw_headings(canvas, Rect { height: 1, ..area }, &columns, focused);
        let list = Rect { y: area.y + 1, height, ..area };
        let from = canvas.scroll_to_row(list, self.selected, self.visible_rows.len());
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

    /// Draws the headings. An arrow shows that there are columns further to the left, and a number counts the columns
    /// further to the right.
    fn draw_headings(
        &self,
        canvas: &mut Canvas<'_>,
        head: Rect,
        columns: &[(usize, (u16, u16))],
        focused: bool,
    ) {
        for (at, place) in columns {
            let column = &self.columns[*at];
            let cell = Rect { x: head.x + place.0, width: place.1, ..head };
            let role = if focused && *at == self.column { Role::Title } else { Role::Header };
            canvas.draw_aligned(cell, &column.title, role, column.align);
        }
        let after_gap = columns.iter().zip(&self.arranged).find(|((at, _), arranged)| at != *arranged);
        if let Some(((_, (x, _)), _)) = after_gap {
            canvas.draw_text(Rect { x: head.x + x - 1, width: 1, ..head }, "←", Role::Key);
        }
        let last = columns.last().and_then(|(last, _)| self.arranged.iter().position(|at| at == last));
        let hidden = self.arranged.len() - last.map_or(0, |last| last + 1);
        if hidden > 0 {
            let mark = format!("+{hidden} →");
            let used = columns.last().map_or(0, |(_, (x, width))| x + width);
            let width = head.width.saturating_sub(used).min(COLUMN_MARK_WIDTH);
            let mark = if usize::from(width) > mark.width() { mark } else { "→".to_owned() };
            let place = Rect { x: head.right() - width, width, ..head };
            canvas.draw_aligned(place, &mark, Role::Key, Align::Right);
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

    /// Returns the widths of the arranged columns, shrunk to fit into a width. Columns with a fixed width are not
    /// shrunk.
    fn fit_widths(&self, width: u16) -> Vec<u16> {
        let all: usize = self.arranged.iter().map(|at| usize::from(self.widths[*at]) + 2).sum();
        let mut missing = all.saturating_sub(usize::from(width) + 2).min(usize::from(u16::MAX)) as u16;
        let fitted = |at: &usize| {
            let (natural_width, column) = (self.widths[*at], &self.columns[*at]);
            if self.layout.fixed_width(&column.title).is_some() {
                return natural_width;
            }
            let given = natural_width.saturating_sub(column.min_width).min(missing);
            missing -= given;
            natural_width - given
        };
        self.arranged.iter().map(fitted).collect()
    }

    /// Returns the columns that fit into a width, with their positions and widths. The pinned columns are always
    /// visible if the selected column fits next to them; otherwise, only the first column is. The other columns are
    /// scrolled until the selected column is visible.
    fn visible_columns(&self, width: u16) -> Vec<(usize, (u16, u16))> {
        let widths = self.fit_widths(width);
        let selected = self.arranged_position();
        let all_pinned = (self.extra_pinned_columns + 1).min(widths.len());
        let used: u16 = widths[..all_pinned].iter().map(|width| width.saturating_add(2)).sum();
        let needed =
            widths.get(selected).map_or(0, |selected| used.saturating_add(selected + COLUMN_MARK_WIDTH));
        let pinned = if needed <= width { all_pinned } else { 1 };
        let mut from = pinned;
        loop {
            let columns = self.columns_from(pinned, from, &widths, width);
            let whole =
                |(place, (_, shown)): &(usize, (u16, u16))| *place == selected && *shown == widths[*place];
            if columns.iter().any(whole) || from >= self.arranged.len() || from >= selected {
                let columns = self.widen_shrunk_columns(columns, width);
                return columns.into_iter().map(|(place, cell)| (self.arranged[place], cell)).collect();
            }
            from += 1;
        }
    }

    /// Gives the width that the visible columns leave unused to columns that were shrunk, from the left.
    fn widen_shrunk_columns(
        &self,
        mut columns: Vec<(usize, (u16, u16))>,
        width: u16,
    ) -> Vec<(usize, (u16, u16))> {
        let Some((last, (x, shown))) = columns.last() else { return columns };
        let mark = if last + 1 < self.arranged.len() { COLUMN_MARK_WIDTH } else { 0 };
        let mut unused = width.saturating_sub(x + shown + mark);
        let mut shift = 0;
        for (place, (x, shown)) in &mut columns {
            *x += shift;
            let wider = self.widths[self.arranged[*place]].saturating_sub(*shown).min(unused);
            *shown += wider;
            shift += wider;
            unused -= wider;
        }
        columns
    }

    /// Returns the pinned columns and those columns from position `from` on that fit into a width, as positions in
    /// display order. If columns do not fit, leaves space for their number.
    fn columns_from(
        &self,
        pinned: usize,
        from: usize,
        widths: &[u16],
        width: u16,
    ) -> Vec<(usize, (u16, u16))> {
        let last = self.arranged.len().saturating_sub(1);
        let mut columns = Vec::new();
        let mut x = 0;
        for place in (0..pinned).chain(from..self.arranged.len()).filter(|place| *place <= last) {
            let number = widths[place];
            // A truncated column must be wide enough for readable text.
            let readable = match self.columns[self.arranged[place]].is_indivisible {
                true => number,
                false => number.min(MIN_TEXT_WIDTH),
            };
            let mark = if place < last { COLUMN_MARK_WIDTH } else { 0 };
            let rest: usize = widths[place..].iter().map(|width| usize::from(*width) + 2).sum();
            let room = match rest <= usize::from(width.saturating_sub(x)) + 2 {
                true => width.saturating_sub(x),
                false => width.saturating_sub(x + mark),
            };
            if x > 0 && room < readable.max(1) {
                break;
            }
            let room = if x == 0 { width } else { room };
            columns.push((place, (x, number.min(room))));
            x += number + 2;
        }
        columns
    }
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
    }

    /// Draws a table and returns the headings and the row.
    fn drawn(table: &Table, width: u16) -> [String; 2] {
        let theme = crate::theme::Theme::bundled("mono").expect("a theme");
        let mut buffer = ratatui::buffer::Buffer::empty(Rect::new(0, 0, width, 2));
        let area = buffer.area;
        table.draw(&mut Canvas::new(&mut buffer, &theme), area, false, 0);
        let row = |y| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>().trim_end().to_owned();
        [row(0), row(1)]
    }

    fn wide_table() -> Table {
        let titles = ["cash", "leads", "churn", "usage"].map(TableColumn::numeric);
        let mut table = Table::new([TableColumn::text("group")].into_iter().chain(titles).collect());
        let numbers =
            [1.0, 2.0, 3.0, 4.0].map(|number| TableCell::from_number(number, format!("{number:.2}")));
        table.set_rows(vec![[TableCell::from_text("S1")].into_iter().chain(numbers).collect()]);
        table
    }

    #[test]
    fn columns_that_do_not_fit_are_counted() {
        let mut table = wide_table();
        assert_eq!(
            drawn(&table, 32),
            ["group  cash  leads  churn  usage", "S1     1.00   2.00   3.00   4.00"]
        );
        assert_eq!(drawn(&table, 31), ["group  cash  leads  churn  +1 →", "S1     1.00   2.00   3.00"]);
        assert_eq!(drawn(&table, 30), ["group  cash  leads        +2 →", "S1     1.00   2.00"]);
        assert_eq!(drawn(&table, 12)[0], "group   +4 →");
        table.select_column(3);
        assert_eq!(drawn(&table, 25)[0], "group ←leads  churn  +1 →");
        table.select_column(4);
        assert_eq!(drawn(&table, 26)[0], "group ←leads  churn  usage");
    }

    #[test]
    fn pinned_columns_stay_visible() {
        let mut table = wide_table();
        table.set_pinned_columns(2);
        table.select_column(4);
        assert_eq!(drawn(&table, 24), ["group  cash ←usage", "S1     1.00   4.00"]);
        assert!(
            drawn(&table, 19)[0].ends_with("usage"),
            "the selected column has priority: {:?}",
            drawn(&table, 19)
        );
    }

    #[test]
    fn layout_hides_moves_and_resizes_columns() {
        let mut table = wide_table();
        let order = ["group", "usage", "cash", "leads", "churn"].map(str::to_owned).to_vec();
        let hidden = ["leads".to_owned()].into();
        let widths = [("churn".to_owned(), 2), ("group".to_owned(), 3)].into();
        table.set_layout(ColumnLayout { order, hidden, widths });
        assert_eq!(
            drawn(&table, 60),
            ["gr…  usage  cash  churn", "S1    4.00  1.00   3.00"],
            "numbers keep their width"
        );
        table.handle_action(ListAction::Right, 5);
        assert_eq!(table.selected_column(), 4, "the index in the original order");
        table.set_layout(ColumnLayout { hidden: ["usage".to_owned()].into(), ..ColumnLayout::default() });
        assert_eq!(table.selected_column(), 0, "a hidden column cannot be selected");
        table.set_layout(ColumnLayout::default());
        assert_eq!(drawn(&table, 60)[0], "group  cash  leads  churn  usage");
    }
}
