//! A list of statements with search and a preview.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::Line;
use unicode_width::UnicodeWidthStr;

use crate::action::Action;
use novamind_tui::canvas::{Canvas, Click, centered, rows_of};
use novamind_tui::fuzzy::{self, Found};
use novamind_tui::sql::tokens;
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;
use novamind_tui::widgets::table::first_row;

/// Below this width the preview is under the list instead of next to it.
const BESIDE: u16 = 110;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedQuery {
    /// Origin in a word; usually empty.
    pub tag: &'static str,
    pub title: String,
    pub what: String,
    /// Preview of the statement.
    pub preview: String,
    pub sql: String,
}

pub struct Picker {
    title: &'static str,
    /// Label of the enter key.
    enter: &'static str,
    items: Vec<ListedQuery>,
    /// Searchable text besides the title: explanation and statement in one line.
    texts: Vec<String>,
    field: Field,
    found: Vec<Found>,
    selected: usize,
}

/// Result of an action.
#[derive(Debug, PartialEq, Eq)]
pub enum PickedQuery {
    /// The list stays open.
    None,
    /// The list closes without a choice.
    Closed,
    /// The chosen statement.
    Statement(String),
}

/// Collapses whitespace to make one line.
pub fn in_a_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

impl Picker {
    /// Creates a list; `enter` is the label of the enter key.
    pub fn new(title: &'static str, enter: &'static str, items: Vec<ListedQuery>) -> Picker {
        let text = |item: &ListedQuery| format!("{} {}", item.what, in_a_line(&item.preview));
        let texts = items.iter().map(text).collect();
        let mut picker =
            Picker { title, enter, items, texts, field: Field::default(), found: Vec::new(), selected: 0 };
        picker.find();
        picker
    }

    pub fn field(&mut self) -> &mut Field {
        &mut self.field
    }

    pub fn find(&mut self) {
        let all = self.items.iter().zip(&self.texts);
        self.found =
            fuzzy::find(self.field.text(), all.map(|(item, text)| (item.title.as_str(), text.as_str())));
        self.selected = 0;
    }

    /// Selects the next entry, cyclically.
    pub fn next(&mut self) {
        self.selected = if self.selected + 1 < self.found.len() { self.selected + 1 } else { 0 };
    }

    fn chosen(&self) -> Option<&ListedQuery> {
        self.found.get(self.selected).map(|(at, _)| &self.items[*at])
    }

    pub fn act(&mut self, action: Action) -> PickedQuery {
        let last = self.found.len().saturating_sub(1);
        match action {
            Action::Commit => {
                return self
                    .chosen()
                    .map_or(PickedQuery::None, |item| PickedQuery::Statement(item.sql.clone()));
            }
            Action::Discard => return PickedQuery::Closed,
            Action::CommitDown | Action::CommitNext | Action::Down => {
                self.selected = (self.selected + 1).min(last);
            }
            Action::CommitPrevious | Action::Up => self.selected = self.selected.saturating_sub(1),
            _ => {}
        }
        PickedQuery::None
    }

    /// Handles a typed key; page keys move the selection.
    pub fn key(&mut self, key: &KeyEvent, page: u16) {
        let (page, last) = (page.max(1) as usize, self.found.len().saturating_sub(1));
        match key.code {
            KeyCode::PageUp => self.selected = self.selected.saturating_sub(page),
            KeyCode::PageDown => self.selected = (self.selected + page).min(last),
            _ if self.field.key(key) => self.find(),
            _ => {}
        }
    }

    pub fn click(&mut self, row: usize) -> PickedQuery {
        self.selected = row.min(self.found.len().saturating_sub(1));
        self.act(Action::Commit)
    }

    /// Draws the list over the screen.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize) {
        let own =
            centered(area, area.width.saturating_sub(4).clamp(20, 150), area.height.saturating_sub(2).max(5));
        canvas.clear(own, Role::Text);
        canvas.clicks.clear();
        let note = format!("{} of {}", self.found.len(), self.items.len());
        let inside = canvas.pane(own, self.title, &note, true);
        let line = Rect { height: 1.min(inside.height), ..inside };
        canvas.text(line, "›", Role::Key);
        self.field.draw(canvas, Rect { x: line.x + 2, width: line.width.saturating_sub(2), ..line });
        let rest = Rect { y: inside.y + 1, height: inside.height.saturating_sub(1), ..inside };
        let [list, preview] = if own.width >= BESIDE {
            Layout::horizontal([Constraint::Percentage(45), Constraint::Percentage(55)]).areas(rest)
        } else {
            let shown = if rest.height >= 9 { rest.height / 2 } else { 0 };
            Layout::vertical([Constraint::Min(0), Constraint::Length(shown)]).areas(rest)
        };
        self.draw_list(canvas, list, pane);
        self.draw_preview(canvas, preview, own.width >= BESIDE);
        canvas.pane_keys(own, &format!("type to find · up/down choose · enter {} · esc close", self.enter));
    }

    fn draw_list(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize) {
        canvas.page = area.height.max(1);
        if self.found.is_empty() {
            canvas.text(area, "No match", Role::Dim);
        }
        let tags = self.items.iter().map(|item| item.tag.width()).max().unwrap_or(0) as u16;
        let from = first_row(self.selected, area.height as usize, self.found.len());
        for (row, (place, (at, letters))) in rows_of(area).zip(self.found.iter().enumerate().skip(from)) {
            let (item, selected) = (&self.items[*at], place == self.selected);
            let role = |other| if selected { Role::Selection } else { other };
            if selected {
                let style = canvas.style(Role::Selection);
                canvas.buffer.set_style(row.intersection(canvas.buffer.area), style);
            }
            let left = if tags > 0 { tags + 1 } else { 0 };
            canvas.text(Rect { width: tags.min(row.width), ..row }, item.tag, role(Role::Dim));
            let title = Rect { x: row.x + left, width: row.width.saturating_sub(left + 1), ..row };
            fuzzy::draw_title(canvas, title, &item.title, letters, [role(Role::Text), role(Role::Key)]);
            canvas.click(row, Click::Row(pane, place));
        }
    }

    fn draw_preview(&self, canvas: &mut Canvas<'_>, area: Rect, beside: bool) {
        let Some(item) = self.chosen() else { return };
        if area.width < 4 || area.height < 2 {
            return;
        }
        let inside = if beside {
            for row in rows_of(area) {
                canvas.text(Rect { width: 1, ..row }, "│", Role::Border);
            }
            Rect { x: area.x + 2, width: area.width - 2, ..area }
        } else {
            let line = "─".repeat(area.width as usize);
            canvas.text(Rect { height: 1, ..area }, &line, Role::Border);
            Rect { y: area.y + 1, height: area.height - 1, ..area }
        };
        let mut rows = rows_of(inside);
        if !item.what.is_empty() {
            for line in wrapped(&item.what, inside.width as usize) {
                let Some(row) = rows.next() else { return };
                canvas.text(row, &line, Role::Strong);
            }
            // A blank row if it fits.
            if inside.height > 8 {
                rows.next();
            }
        }
        for (row, line) in rows.zip(coloured(canvas, item.preview.trim(), inside.width.into())) {
            canvas.line(row, &line);
        }
    }
}

/// Returns a highlighted statement, wrapped with indented continuation lines.
fn coloured(canvas: &Canvas<'_>, sql: &str, width: usize) -> Vec<Line<'static>> {
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
    for token in tokens(sql) {
        push(&sql[done..token.place.start], Role::Text);
        push(&sql[token.place.clone()], token.kind.role());
        done = token.place.end;
    }
    push(&sql[done..], Role::Text);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crossterm::event::KeyModifiers;

    fn item(title: &str, sql: &str) -> ListedQuery {
        ListedQuery {
            tag: "",
            title: title.to_owned(),
            what: String::new(),
            preview: sql.to_owned(),
            sql: sql.to_owned(),
        }
    }

    fn typed(picker: &mut Picker, text: &str) {
        for letter in text.chars() {
            picker.key(&KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE), 5);
        }
    }

    #[test]
    fn typing_narrows_and_the_statement_is_searched_too() {
        let all =
            vec![item("first", "SELECT 1"), item("second", "SELECT day FROM ledger"), item("third", "x")];
        let mut picker = Picker::new("All", "takes", all);
        assert_eq!(picker.act(Action::Commit), PickedQuery::Statement("SELECT 1".to_owned()));
        typed(&mut picker, "ledger");
        assert_eq!(picker.act(Action::Commit), PickedQuery::Statement("SELECT day FROM ledger".to_owned()));
        typed(&mut picker, "zzz");
        assert_eq!(picker.act(Action::Commit), PickedQuery::None);
        assert_eq!(picker.act(Action::Discard), PickedQuery::Closed);
    }

    #[test]
    fn long_lines_of_a_statement_go_on_below() {
        let theme = novamind_tui::theme::Theme::bundled("dark");
        let mut buffer = ratatui::buffer::Buffer::empty(Rect::new(0, 0, 9, 9));
        let theme = theme.expect("a theme");
        let canvas = Canvas::new(&mut buffer, &theme);
        let lines = coloured(&canvas, "SELECT day, amount, note FROM ledger\nWHERE 1", 20);
        let text: Vec<String> = lines.iter().map(|line| line.to_string()).collect();
        assert_eq!(text, ["SELECT day, amount, ", "        note FROM ", "        ledger", "WHERE 1"]);
    }

    #[test]
    fn the_list_is_walked_by_one_by_page_and_round() {
        let all: Vec<ListedQuery> = (0..12).map(|at| item(&format!("q{at}"), &at.to_string())).collect();
        let mut picker = Picker::new("All", "takes", all);
        picker.act(Action::CommitPrevious);
        picker.key(&KeyEvent::new(KeyCode::PageDown, KeyModifiers::NONE), 5);
        picker.act(Action::CommitDown);
        assert_eq!(picker.selected, 6);
        for _ in 0..6 {
            picker.next();
        }
        assert_eq!(picker.selected, 0);
        picker.key(&KeyEvent::new(KeyCode::PageUp, KeyModifiers::NONE), 5);
        assert_eq!(picker.click(99), PickedQuery::Statement("11".to_owned()));
    }
}
