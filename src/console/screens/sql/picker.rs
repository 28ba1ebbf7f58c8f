//! A list of statements with search and a preview.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::Line;
use unicode_width::UnicodeWidthStr;

use crate::action::Action;
use novamind_tui::canvas::{Canvas, Click, centered_rect, row_rects};
use novamind_tui::fuzzy::{self, FuzzyMatch};
use novamind_tui::sql::tokenize;
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;

/// Minimum width for a preview next to the list. In narrower windows, the preview is below the list.
const MIN_WIDTH_FOR_SIDE_PREVIEW: u16 = 110;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PickerItem {
    /// One-word origin of the statement, or an empty text. Most statements have no origin.
    pub tag: &'static str,
    pub title: String,
    pub description: String,
    /// Preview of the statement.
    pub preview: String,
    pub sql: String,
}

pub struct Picker {
    title: &'static str,
    /// Label of the enter key.
    enter_label: &'static str,
    items: Vec<PickerItem>,
    /// Searchable text of each item in addition to the title: explanation and statement in one line.
    search_texts: Vec<String>,
    field: TextField,
    matches: Vec<FuzzyMatch>,
    selected: usize,
}

/// Result of an action in the picker.
#[derive(Debug, PartialEq, Eq)]
pub enum PickerResult {
    /// Nothing was chosen, and the list stays open.
    None,
    /// Nothing was chosen, and the list closes.
    Closed,
    /// The statement that the user chose.
    Statement(String),
}

/// Replaces each run of whitespace by a space, so that the text is one line.
pub fn single_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

impl Picker {
    /// Returns a picker with a list of items. `enter` is the label of the enter key.
    pub fn new(title: &'static str, enter: &'static str, items: Vec<PickerItem>) -> Picker {
        let text = |item: &PickerItem| format!("{} {}", item.description, single_line(&item.preview));
        let texts = items.iter().map(text).collect();
        let mut picker =
            Picker { title, enter_label: enter, items, search_texts: texts, field: TextField::default(), matches: Vec::new(), selected: 0 };
        picker.update_matches();
        picker
    }

    pub fn field(&mut self) -> &mut TextField {
        &mut self.field
    }

    pub fn update_matches(&mut self) {
        let all = self.items.iter().zip(&self.search_texts);
        self.matches =
            fuzzy::find(self.field.text(), all.map(|(item, text)| (item.title.as_str(), text.as_str())));
        self.selected = 0;
    }

    /// Selects the next item, cyclically.
    pub fn select_next(&mut self) {
        self.selected = if self.selected + 1 < self.matches.len() { self.selected + 1 } else { 0 };
    }

    fn selected_item(&self) -> Option<&PickerItem> {
        self.matches.get(self.selected).map(|(at, _)| &self.items[*at])
    }

    pub fn handle_action(&mut self, action: Action) -> PickerResult {
        let last = self.matches.len().saturating_sub(1);
        match action {
            Action::Commit => {
                return self
                    .selected_item()
                    .map_or(PickerResult::None, |item| PickerResult::Statement(item.sql.clone()));
            }
            Action::Discard => return PickerResult::Closed,
            Action::CommitDown | Action::CommitNext | Action::Down => {
                self.selected = (self.selected + 1).min(last);
            }
            Action::CommitPrevious | Action::Up => self.selected = self.selected.saturating_sub(1),
            _ => {}
        }
        PickerResult::None
    }

    /// Handles a key in the search field. Page keys move the selection.
    pub fn handle_key(&mut self, key: &KeyEvent, page: u16) {
        let (page, last) = (page.max(1) as usize, self.matches.len().saturating_sub(1));
        match key.code {
            KeyCode::PageUp => self.selected = self.selected.saturating_sub(page),
            KeyCode::PageDown => self.selected = (self.selected + page).min(last),
            _ if self.field.handle_key(key) => self.update_matches(),
            _ => {}
        }
    }

    pub fn handle_click(&mut self, row: usize) -> PickerResult {
        self.selected = row.min(self.matches.len().saturating_sub(1));
        self.handle_action(Action::Commit)
    }

    /// Draws the picker over the screen.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize) {
        let dialog_area =
            centered_rect(area, area.width.saturating_sub(4).clamp(20, 150), area.height.saturating_sub(2).max(5));
        canvas.clear(dialog_area, Role::Text);
        canvas.clicks.clear();
        let note = format!("{} of {}", self.matches.len(), self.items.len());
        let inside = canvas.draw_pane_frame(dialog_area, self.title, &note, true);
        let line = Rect { height: 1.min(inside.height), ..inside };
        canvas.draw_text(line, "›", Role::Key);
        self.field.draw(canvas, Rect { x: line.x + 2, width: line.width.saturating_sub(2), ..line });
        let rest = Rect { y: inside.y + 1, height: inside.height.saturating_sub(1), ..inside };
        let [list, preview] = if dialog_area.width >= MIN_WIDTH_FOR_SIDE_PREVIEW {
            Layout::horizontal([Constraint::Percentage(45), Constraint::Percentage(55)]).areas(rest)
        } else {
            let shown = if rest.height >= 9 { rest.height / 2 } else { 0 };
            Layout::vertical([Constraint::Min(0), Constraint::Length(shown)]).areas(rest)
        };
        self.draw_list(canvas, list, pane);
        self.draw_preview(canvas, preview, dialog_area.width >= MIN_WIDTH_FOR_SIDE_PREVIEW);
        canvas.draw_pane_keys(dialog_area, &format!("type to find · up/down choose · enter {} · esc close", self.enter_label));
    }

    fn draw_list(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize) {
        canvas.page_rows = area.height.max(1);
        if self.matches.is_empty() {
            canvas.draw_text(area, "No match", Role::Dim);
        }
        let tags = self.items.iter().map(|item| item.tag.width()).max().unwrap_or(0) as u16;
        let from = canvas.scroll_to_row(area, self.selected, self.matches.len());
        for (row, (place, (at, letters))) in row_rects(area).zip(self.matches.iter().enumerate().skip(from)) {
            let (item, selected) = (&self.items[*at], place == self.selected);
            let role = |other| if selected { Role::Selection } else { other };
            if selected {
                let style = canvas.style(Role::Selection);
                canvas.buffer.set_style(row.intersection(canvas.buffer.area), style);
            }
            let left = if tags > 0 { tags + 1 } else { 0 };
            canvas.draw_text(Rect { width: tags.min(row.width), ..row }, item.tag, role(Role::Dim));
            let title = Rect { x: row.x + left, width: row.width.saturating_sub(left + 1), ..row };
            fuzzy::draw_title(canvas, title, &item.title, letters, [role(Role::Text), role(Role::Key)]);
            canvas.register_click(row, Click::Row(pane, place));
        }
    }

    fn draw_preview(&self, canvas: &mut Canvas<'_>, area: Rect, is_side_by_side: bool) {
        let Some(item) = self.selected_item() else { return };
        if area.width < 4 || area.height < 2 {
            return;
        }
        let inside = if is_side_by_side {
            for row in row_rects(area) {
                canvas.draw_text(Rect { width: 1, ..row }, "│", Role::Border);
            }
            Rect { x: area.x + 2, width: area.width - 2, ..area }
        } else {
            let line = "─".repeat(area.width as usize);
            canvas.draw_text(Rect { height: 1, ..area }, &line, Role::Border);
            Rect { y: area.y + 1, height: area.height - 1, ..area }
        };
        let mut rows = row_rects(inside);
        if !item.description.is_empty() {
            for line in wrap(&item.description, inside.width as usize) {
                let Some(row) = rows.next() else { return };
                canvas.draw_text(row, &line, Role::Strong);
            }
            // A blank row is added if it fits.
            if inside.height > 8 {
                rows.next();
            }
        }
        for (row, line) in rows.zip(highlighted_lines(canvas, item.preview.trim(), inside.width.into())) {
            canvas.draw_line(row, &line);
        }
    }
}

/// Returns the lines of a highlighted statement. Continuation lines are indented.
fn highlighted_lines(canvas: &Canvas<'_>, sql: &str, width: usize) -> Vec<Line<'static>> {
    const INDENT: &str = "        ";
    let mut lines = vec![Line::default()];
    let mut used = 0;
    let mut push = |text: &str, role: Role| {
        for (at, part) in text.split('\n').enumerate() {
            if at > 0 {
                lines.push(Line::default());
                used = 0;
            }
            for word in part.split_inclusive(' ') {
                if used > INDENT.len() && used + word.trim_end().width() > width {
                    lines.push(Line::from(INDENT));
                    used = INDENT.len();
                }
                used += word.width();
                if let Some(line) = lines.last_mut() {
                    line.push_span(canvas.span(word.to_owned(), role));
                }
            }
        }
    };
    let mut done = 0;
    for token in tokenize(sql) {
        push(&sql[done..token.range.start], Role::Text);
        push(&sql[token.range.clone()], token.kind.role());
        done = token.range.end;
    }
    push(&sql[done..], Role::Text);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crossterm::event::KeyModifiers;

    fn picker_item(title: &str, sql: &str) -> PickerItem {
        PickerItem {
            tag: "",
            title: title.to_owned(),
            description: String::new(),
            preview: sql.to_owned(),
            sql: sql.to_owned(),
        }
    }

    fn type_text(picker: &mut Picker, text: &str) {
        for letter in text.chars() {
            picker.handle_key(&KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE), 5);
        }
    }

    #[test]
    fn typing_searches_titles_and_statements() {
        let all =
            vec![picker_item("first", "SELECT 1"), picker_item("second", "SELECT day FROM ledger"), picker_item("third", "x")];
        let mut picker = Picker::new("All", "takes", all);
        assert_eq!(picker.handle_action(Action::Commit), PickerResult::Statement("SELECT 1".to_owned()));
        type_text(&mut picker, "ledger");
        assert_eq!(picker.handle_action(Action::Commit), PickerResult::Statement("SELECT day FROM ledger".to_owned()));
        type_text(&mut picker, "zzz");
        assert_eq!(picker.handle_action(Action::Commit), PickerResult::None);
        assert_eq!(picker.handle_action(Action::Discard), PickerResult::Closed);
    }

    #[test]
    fn long_statement_lines_wrap() {
        let theme = novamind_tui::theme::Theme::bundled("dark");
        let mut buffer = ratatui::buffer::Buffer::empty(Rect::new(0, 0, 9, 9));
        let theme = theme.expect("a theme");
        let canvas = Canvas::new(&mut buffer, &theme);
        let lines = highlighted_lines(&canvas, "SELECT day, amount, note FROM ledger\nWHERE 1", 20);
        let text: Vec<String> = lines.iter().map(|line| line.to_string()).collect();
        assert_eq!(text, ["SELECT day, amount, ", "        note FROM ", "        ledger", "WHERE 1"]);
    }

    #[test]
    fn selection_moves_by_row_and_page_and_wraps() {
        let all: Vec<PickerItem> = (0..12).map(|at| picker_item(&format!("q{at}"), &at.to_string())).collect();
        let mut picker = Picker::new("All", "takes", all);
        picker.handle_action(Action::CommitPrevious);
        picker.handle_key(&KeyEvent::new(KeyCode::PageDown, KeyModifiers::NONE), 5);
        picker.handle_action(Action::CommitDown);
        assert_eq!(picker.selected, 6);
        for _ in 0..6 {
            picker.select_next();
        }
        assert_eq!(picker.selected, 0);
        picker.handle_key(&KeyEvent::new(KeyCode::PageUp, KeyModifiers::NONE), 5);
        assert_eq!(picker.handle_click(99), PickerResult::Statement("11".to_owned()));
    }
}
