//! A multi-line text editor, based on the text area of a library.

use std::cmp::Ordering;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use ratatui::widgets::Widget;
use tui_textarea::{CursorMove, TextArea, WrapMode};

use super::ListAction;
use crate::canvas::Canvas;
use crate::theme::Role;

/// A multi-line text editor.
#[derive(Debug, Clone)]
pub struct TextEditor {
    area: TextArea<'static>,
}

/// Editing keys: key, label and description.
pub const EDITING_KEYS: [(&str, &str, &str); 4] = [
    ("ctrl-u", "line start", "Remove the text to the start of the line."),
    ("ctrl-k", "line end", "Remove the text to the end of the line."),
    ("ctrl-w", "word", "Remove the word before the cursor."),
    ("ctrl-z", "undo typing", "Undo the last change to the text."),
];

/// Maximum length of an edited text, in bytes.
pub const MAX_BYTES: usize = 256 << 10;

impl Default for TextEditor {
    fn default() -> Self {
        TextEditor::with_text("")
    }
}

impl TextEditor {
    /// Returns an editor with a text and the cursor at its end.
    pub fn with_text(text: &str) -> TextEditor {
        let lines = text.lines().map(|line| line.replace('\t', "    ")).collect();
        let mut area = TextArea::new(lines);
        area.set_wrap_mode(WrapMode::WordOrGlyph);
        area.set_tab_length(4);
        // The terminal cursor marks the position, so the cursor line needs no style.
        area.set_cursor_line_style(Style::new());
        area.set_cursor_style(Style::new());
        area.move_cursor(CursorMove::Bottom);
        area.move_cursor(CursorMove::End);
        TextEditor { area }
    }

    /// Disables wrapping, for text such as code, in which line breaks have a meaning.
    pub fn without_wrapping(mut self) -> TextEditor {
        self.area.set_wrap_mode(WrapMode::None);
        self
    }

    /// Returns the complete text of the editor.
    pub fn text(&self) -> String {
        self.area.lines().join("\n")
    }

    /// Returns the lines of the text.
    pub fn lines(&self) -> &[String] {
        self.area.lines()
    }

    /// Returns whether the text contains only whitespace.
    pub fn is_blank(&self) -> bool {
        self.area.lines().iter().all(|line| line.trim().is_empty())
    }

    /// Returns the row and column of the cursor, in characters.
    pub fn cursor(&self) -> (usize, usize) {
        let cursor = self.area.cursor();
        (cursor.0, cursor.1)
    }

    /// Returns the first visible row and column.
    pub fn scroll_offset(&self) -> (u16, u16) {
        self.area.scroll_offset()
    }

    /// Handles a key. Ctrl-U deletes to the start of the line, as in text fields, and Ctrl-Z undoes the last change.
    pub fn handle_key(&mut self, key: &KeyEvent) {
        let ctrl = key.modifiers.contains(KeyModifiers::CONTROL);
        match key.code {
            KeyCode::Char('u') if ctrl && self.cursor().1 > 0 => {
                self.area.delete_line_by_head();
            }
            KeyCode::Char('u') if ctrl => {}
            KeyCode::Char('z') if ctrl => {
                self.area.undo();
            }
            _ => {
                self.area.input(*key);
            }
        }
    }

    /// Inserts text at the cursor, up to the maximum length.
    pub fn insert(&mut self, text: &str) {
        if self.text().len() + text.len() <= MAX_BYTES {
            let clean: String = text.replace("\r\n", "\n").replace('\r', "\n").replace('\t', "    ");
            let visible = |letter: &char| *letter == '\n' || !letter.is_control();
            self.area.insert_str(clean.chars().filter(visible).collect::<String>());
        }
    }

    /// Replaces the text of the editor. Ctrl-Z restores the replaced text.
    pub fn set_text(&mut self, text: &str) {
        self.area.select_all();
        self.area.cut();
        self.insert(text);
    }

    /// Moves the cursor to a row and a column, in characters.
    pub fn move_to(&mut self, row: usize, column: usize) {
        let number = |value: usize| u16::try_from(value).unwrap_or(u16::MAX);
        self.area.cancel_selection();
        self.area.move_cursor(CursorMove::Jump(number(row), number(column)));
    }

    /// Scrolls the text in a window of `page` rows, for a text that is not being edited. The cursor moves to a row that
    /// becomes visible.
    pub fn scroll(&mut self, action: impl Into<Option<ListAction>>, page: usize) {
        let top = usize::from(self.scroll_offset().0);
        let target = match action.into() {
            Some(ListAction::Up | ListAction::ScrollUp) => top.saturating_sub(1),
            Some(ListAction::Down | ListAction::ScrollDown) => top + page,
            Some(ListAction::PageUp) => top.saturating_sub(page),
            Some(ListAction::PageDown) => top + (2 * page).saturating_sub(1),
            Some(ListAction::First) => 0,
            Some(ListAction::Last) => usize::MAX,
            _ => return,
        };
        loop {
            let row = self.area.screen_cursor().row;
            match row.cmp(&target) {
                Ordering::Less => self.area.move_cursor(CursorMove::Down),
                Ordering::Equal => return,
                Ordering::Greater => self.area.move_cursor(CursorMove::Up),
            }
            if self.area.screen_cursor().row == row {
                return;
            }
        }
    }

    /// Deletes a number of characters before the cursor.
    pub fn delete_before_cursor(&mut self, count: usize) {
        for _ in 0..count {
            self.area.delete_char();
        }
    }

    /// Draws the editor. Shows the cursor while the user edits the text.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, editing: bool, hint: &str) {
        if area.is_empty() {
            return;
        }
        if self.is_blank() && !editing {
            canvas.draw_text(area, hint, Role::Dim);
            return;
        }
        (&self.area).render(area, canvas.buffer);
        if self.is_blank() {
            canvas.draw_text(area, hint, Role::Dim);
        }
        if editing {
            let cursor = self.area.screen_cursor();
            let (top, left) = self.area.scroll_offset();
            let x = area.x + (cursor.col as u16).saturating_sub(left).min(area.width - 1);
            let y = area.y + (cursor.row as u16).saturating_sub(top).min(area.height - 1);
            canvas.cursor = Some(Position::new(x, y));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratatui::buffer::Buffer;

    #[test]
    fn text_above_the_window_is_reached_by_scrolling() {
        let editor = &mut TextEditor::with_text("first words of a wrapped line\n\n\n\n\n\n\n.");
        let area = Rect::new(0, 0, 12, 4);
        let top_row = |editor: &mut TextEditor, action: Option<ListAction>| {
            if let Some(action) = action {
                editor.scroll(action, area.height.into());
            }
            let mut buffer = Buffer::empty(area);
            (&editor.area).render(area, &mut buffer);
            (0..area.width).map(|x| buffer[(x, 0)].symbol().to_owned()).collect::<String>().trim().to_owned()
        };
        assert_eq!(top_row(editor, None), "");
        let ups: Vec<String> = (0..6).map(|_| top_row(editor, Some(ListAction::Up))).collect();
        assert_eq!(ups, ["", "", "", "line", "of a wrapped", "first words"].map(str::to_owned));
        assert_eq!(top_row(editor, Some(ListAction::Last)), "");
        assert!(top_row(editor, Some(ListAction::First)).starts_with("first"));
        assert_ne!(top_row(editor, Some(ListAction::Down)), "first words");
    }
}
