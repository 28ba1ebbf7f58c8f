//! The SQL editor with highlighting, completion and error positions.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use unicode_width::UnicodeWidthStr;

use super::completion::{Completion, complete};
use novamind_database::Interface;
use novamind_tui::canvas::{Align, Canvas, row_rects};
use novamind_tui::sql::{is_identifier_char, statement_at, tokenize};
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextEditor;

/// Minimum length of a word for suggestions while typing.
const MIN_TYPED_CHARS: usize = 2;
/// Maximum number of visible suggestions.
const MAX_VISIBLE_CANDIDATES: u16 = 8;

/// A statement, and its position in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Statement {
    pub sql: String,
    /// Byte offset of the statement in the editor text.
    pub offset: usize,
}

pub struct QueryEditor {
    /// Release whose tables are suggested.
    pub interface: Interface,
    text: TextEditor,
    completion: Option<Completion>,
    error_offset: Option<usize>,
}

impl Default for QueryEditor {
    fn default() -> Self {
        QueryEditor {
            interface: Interface::default(),
            text: TextEditor::default().without_wrapping(),
            completion: None,
            error_offset: None,
        }
    }
}

impl QueryEditor {
    pub fn text(&self) -> String {
        self.text.text()
    }

    /// Returns whether the editor contains only whitespace.
    pub fn is_blank(&self) -> bool {
        self.text.is_blank()
    }

    pub fn replace(&mut self, sql: &str) {
        self.text.set_text(sql);
        self.on_change();
    }

    fn on_change(&mut self) {
        (self.completion, self.error_offset) = (None, None);
    }

    fn cursor_offset(&self) -> usize {
        let (row, column) = self.text.cursor();
        let lines = self.text.lines();
        let above: usize = lines.iter().take(row).map(|line| line.len() + 1).sum();
        let before = lines.get(row).map_or(0, |line| line.chars().take(column).map(char::len_utf8).sum());
        above + before
    }

    /// Returns the statement at the cursor, or `None` if the statement is empty.
    pub fn statement(&self) -> Option<Statement> {
        let text = self.text();
        let (range, ..) = statement_at(&text, self.cursor_offset());
        let whole = &text[range.clone()];
        let from = range.start + (whole.len() - whole.trim_start().len());
        let sql = whole.trim().to_owned();
        (!sql.is_empty()).then_some(Statement { sql, offset: from })
    }

    /// Returns the index of the statement at the cursor, and the number of statements.
    pub fn statement_position(&self) -> (usize, usize) {
        let (_, number, count) = statement_at(&self.text(), self.cursor_offset());
        (number, count)
    }

    /// Marks an error at a byte offset and moves the cursor to this offset.
    pub fn mark_error(&mut self, place: usize) {
        let text = self.text();
        let place = (0..=place.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
        let before = &text[..place];
        let row = before.matches('\n').count();
        let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count());
        self.text.move_to(row, column);
        self.completion = None;
        self.error_offset = Some(place);
    }

    /// Moves the cursor to the start of the text.
    pub fn go_to_top(&mut self) {
        self.text.move_to(0, 0);
    }

    pub fn handle_key(&mut self, key: &KeyEvent) {
        if let Some(completion) = &mut self.completion {
            let last = completion.candidates.len() - 1;
            match key.code {
                KeyCode::Up => return completion.selected = completion.selected.checked_sub(1).unwrap_or(last),
                KeyCode::Down => {
                    return completion.selected =
                        if completion.selected == last { 0 } else { completion.selected + 1 };
                }
                _ => {}
            }
        }
        let before = self.text.cursor();
        let count = self.text.lines().len();
        self.text.handle_key(key);
        let types = match key.code {
            KeyCode::Char(letter) => is_identifier_char(letter) || letter == '.',
            // Deleting a character updates open suggestions but does not open them.
            KeyCode::Backspace => self.completion.is_some(),
            _ => false,
        };
        let moved_only = matches!(
            key.code,
            KeyCode::Left | KeyCode::Right | KeyCode::Up | KeyCode::Down | KeyCode::Home | KeyCode::End
        );
        if !moved_only && (before != self.text.cursor() || count != self.text.lines().len()) {
            self.error_offset = None;
        }
        self.completion = if types { self.complete(MIN_TYPED_CHARS) } else { None };
    }

    fn complete(&self, least: usize) -> Option<Completion> {
        complete(&self.text(), self.cursor_offset(), least, self.interface)
    }

    pub fn paste(&mut self, text: &str) {
        self.text.insert(text);
        self.on_change();
    }

    /// Inserts the selected suggestion. If no suggestions are open, shows suggestions. If there are no suggestions,
    /// inserts spaces at the cursor up to the next multiple of four columns.
    pub fn accept_or_offer_completion(&mut self) {
        match self.completion.take().or_else(|| self.complete(1)) {
            Some(completion) => {
                let chosen = &completion.candidates[completion.selected];
                self.text.delete_before_cursor(completion.typed_chars);
                self.text.insert(&chosen.word);
            }
            None => {
                let column = self.text.cursor().1;
                self.text.insert(&" ".repeat(4 - column % 4));
            }
        }
        self.on_change();
    }

    /// Hides the suggestions. Returns whether suggestions were shown.
    pub fn hide_completion(&mut self) -> bool {
        self.completion.take().is_some()
    }

    /// Inserts a name at the cursor, with a separator after the text before the cursor.
    pub fn insert_name(&mut self, name: &str, after_another: bool) {
        let text = self.text();
        let last = text[..self.cursor_offset()].chars().next_back();
        let apart = match last {
            Some(letter) if is_identifier_char(letter) && after_another => ", ",
            Some(letter) if is_identifier_char(letter) || matches!(letter, ',' | ')' | '*') => " ",
            _ => "",
        };
        self.text.insert(&format!("{apart}{name}"));
        self.on_change();
    }

    /// Draws the text with SQL highlighting.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, editing: bool, hint: &str) {
        self.text.draw(canvas, area, editing, hint);
        if self.is_blank() || area.is_empty() {
            return;
        }
        let text = self.text();
        for token in tokenize(&text) {
            self.style_range(canvas, area, &text, token.range, canvas.style(token.kind.role()));
        }
        if let Some(mark) = self.error_offset {
            let token = tokenize(&text).into_iter().map(|token| token.range).find(|place| place.end > mark);
            let place = token.unwrap_or(text.len().saturating_sub(1)..text.len());
            let style = canvas.style(Role::Bad).add_modifier(Modifier::UNDERLINED);
            self.style_range(canvas, area, &text, place, style);
        }
    }

    /// Changes the style of a range of text that is already drawn.
    fn style_range(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        text: &str,
        place: std::ops::Range<usize>,
        style: Style,
    ) {
        let (top, left) = self.text.scroll_offset();
        let area = area.intersection(canvas.buffer.area);
        let Some(piece) = text.get(place.clone()) else { return };
        let first_row = text[..place.start].matches('\n').count();
        for (at, line) in piece.split('\n').enumerate() {
            let row = (first_row + at) as i64 - i64::from(top);
            let before = match at {
                0 => text[..place.start].rsplit('\n').next().map_or(0, |line| line.width()),
                _ => 0,
            };
            let from = (before as i64 - i64::from(left)).clamp(0, i64::from(area.width));
            let to = ((before + line.width()) as i64 - i64::from(left)).clamp(0, i64::from(area.width));
            if (0..i64::from(area.height)).contains(&row) && to > from {
                let cells = Rect {
                    x: area.x + from as u16,
                    y: area.y + row as u16,
                    width: (to - from) as u16,
                    height: 1,
                };
                canvas.buffer.set_style(cells, style);
            }
        }
    }

    /// Draws the list of suggestions next to the cursor, within an area.
    pub fn draw_completion(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let (Some(completion), Some(cursor)) = (&self.completion, canvas.cursor) else { return };
        let area = area.intersection(canvas.buffer.area);
        let widest = |of: fn(&super::completion::Candidate) -> &str| {
            completion.candidates.iter().map(|one| of(one).width()).max().unwrap_or(0)
        };
        let words = widest(|one| &one.word) as u16;
        let width = (words + widest(|one| &one.description) as u16 + 6).min(area.width);
        let rows = (completion.candidates.len() as u16).min(MAX_VISIBLE_CANDIDATES);
        let (above, below) = (cursor.y.saturating_sub(area.y), area.bottom().saturating_sub(cursor.y + 1));
        let (y, height) = match below >= rows + 2 || below >= above {
            true => (cursor.y + 1, (rows + 2).min(below)),
            false => (cursor.y - (rows + 2).min(above), (rows + 2).min(above)),
        };
        if height < 3 || width < 8 {
            return;
        }
        let x = cursor.x.saturating_sub(completion.typed_chars as u16 + 2).max(area.x).min(area.right() - width);
        let list_area = Rect { x, y, width, height };
        canvas.clear(list_area, Role::Field);
        let inside = canvas.draw_pane_frame(list_area, "", "", true);
        let from = canvas.scroll_to_row(inside, completion.selected, completion.candidates.len());
        for (row, (at, one)) in row_rects(inside).zip(completion.candidates.iter().enumerate().skip(from)) {
            let chosen = at == completion.selected;
            canvas.clear(row, if chosen { Role::Selection } else { Role::Field });
            let word = Rect { x: row.x + 1, width: words.min(row.width.saturating_sub(2)), ..row };
            let what_width = row.width.saturating_sub(words + 4);
            canvas.draw_text(word, &one.word, if chosen { Role::Selection } else { Role::Field });
            let what = Rect { x: row.right() - what_width - 1, width: what_width, ..row };
            canvas.draw_aligned(what, &one.description, if chosen { Role::Selection } else { Role::Dim }, Align::Right);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crossterm::event::KeyModifiers;

    fn editor_after_typing(text: &str) -> QueryEditor {
        let mut editor = QueryEditor::default();
        for letter in text.chars() {
            editor.handle_key(&KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE));
        }
        editor
    }

    #[test]
    fn tab_accepts_the_selected_suggestion() {
        let mut editor = editor_after_typing("sel");
        assert!(editor.completion.is_some());
        editor.accept_or_offer_completion();
        assert_eq!(editor.text(), "SELECT");
        let mut editor = editor_after_typing("SELECT * FROM led");
        editor.accept_or_offer_completion();
        assert_eq!(editor.text(), "SELECT * FROM ledger");
        editor.accept_or_offer_completion();
        assert_eq!(editor.text(), "SELECT * FROM ledger    ", "nothing to complete: indented");
    }

    #[test]
    fn completion_captures_arrows_but_not_enter() {
        let mut editor = editor_after_typing("sel");
        editor.handle_key(&KeyEvent::new(KeyCode::Enter, KeyModifiers::NONE));
        assert_eq!(editor.text(), "sel\n");
        let mut editor = editor_after_typing("SELECT\nli");
        let offered = editor.completion.as_ref().expect("LIMIT, LIKE").candidates.len();
        assert!(offered > 1);
        editor.handle_key(&KeyEvent::new(KeyCode::Up, KeyModifiers::NONE));
        assert_eq!(editor.completion.as_ref().map(|completion| completion.selected), Some(offered - 1));
        assert!(editor.hide_completion() && !editor.hide_completion());
        editor.handle_key(&KeyEvent::new(KeyCode::Up, KeyModifiers::NONE));
        assert_eq!(editor.cursor_offset(), 2, "now the cursor moves");
    }

    #[test]
    fn error_offsets_are_converted_to_cursor_positions() {
        let mut editor = QueryEditor::default();
        editor.replace("SELECT 'é日',\n  wrong FROM ledger");
        editor.mark_error("SELECT 'é日',\n  ".len());
        assert_eq!(editor.text.cursor(), (1, 2));
        editor.mark_error(9);
        assert_eq!(editor.text.cursor(), (0, 8), "within a character the cursor moves to its start");
        editor.mark_error(999);
        assert_eq!(editor.cursor_offset(), editor.text().len());
    }

    #[test]
    fn statement_returns_the_statement_at_the_cursor() {
        let mut editor = QueryEditor::default();
        editor.replace("SELECT 1;\n\nSELECT 2;");
        assert_eq!(editor.statement(), Some(Statement { sql: "SELECT 2".to_owned(), offset: 11 }));
        assert_eq!(editor.statement_position(), (2, 2));
        editor.replace(" \n ");
        assert_eq!(editor.statement(), None);
    }

    #[test]
    fn inserted_names_are_separated() {
        let mut editor = editor_after_typing("SELECT");
        editor.insert_name("day", false);
        editor.insert_name("amount", true);
        assert_eq!(editor.text(), "SELECT day, amount");
    }

    #[test]
    fn error_is_underlined_until_the_next_edit() {
        let theme = novamind_tui::theme::Theme::bundled("mono");
        let theme = theme.expect("a theme");
        let area = Rect::new(0, 0, 40, 3);
        let underlined = |editor: &QueryEditor| {
            let mut buffer = ratatui::buffer::Buffer::empty(area);
            editor.draw(&mut Canvas::new(&mut buffer, &theme), area, false, "");
            let marked = |x: &u16| buffer[(*x, 0)].style().add_modifier.contains(Modifier::UNDERLINED);
            (0..40).filter(marked).collect::<Vec<u16>>()
        };
        let mut editor = QueryEditor::default();
        editor.replace("SELECT wrong FROM ledger");
        assert!(underlined(&editor).is_empty());
        editor.mark_error(7);
        assert_eq!(underlined(&editor), [7, 8, 9, 10, 11]);
        editor.handle_key(&KeyEvent::new(KeyCode::Char('x'), KeyModifiers::NONE));
        assert!(underlined(&editor).is_empty());
    }
}
