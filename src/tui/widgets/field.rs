//! A single-line text field.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::{Position, Rect};
use unicode_segmentation::UnicodeSegmentation;
use unicode_width::UnicodeWidthStr;

use crate::canvas::Canvas;
use crate::theme::Role;

/// A single-line text field with a cursor between graphemes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TextField {
    text: String,
    /// Number of graphemes before the cursor.
    cursor: usize,
    /// Whether the text is selected, so that the first typed letter replaces it.
    selected: bool,
}

/// Maximum length of the text in bytes, which limits accidental pastes.
const MAX_BYTES: usize = 4096;
/// Maximum length of a pasted number in characters.
const MAX_NUMBER_LENGTH: usize = 32;

impl TextField {
    /// Returns a field with a text and the cursor at its end.
    pub fn with_text(text: impl Into<String>) -> TextField {
        let text = text.into();
        let cursor = text.graphemes(true).count();
        TextField { text, cursor, selected: false }
    }

    /// Returns a field whose text is selected. The first typed letter replaces the text, and backspace deletes it.
    /// Other keys only clear the selection.
    pub fn with_selected_text(text: impl Into<String>) -> TextField {
        TextField { selected: true, ..TextField::with_text(text) }
    }

    /// Returns the text of the field.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns whether the next letter replaces the text.
    pub fn is_selected(&self) -> bool {
        self.selected
    }

    /// Returns whether the text is empty.
    pub fn is_empty(&self) -> bool {
        self.text.is_empty()
    }

    /// Returns a copy of the field in which every letter is a dot.
    pub fn masked(&self) -> TextField {
        let dots = "•".repeat(self.text.graphemes(true).count());
        TextField { text: dots, cursor: self.cursor, selected: self.selected }
    }

    /// Handles a key. Returns false if the field does not use the key.
    pub fn handle_key(&mut self, key: &KeyEvent) -> bool {
        let ctrl = key.modifiers.contains(KeyModifiers::CONTROL);
        let removes = matches!(key.code, KeyCode::Backspace | KeyCode::Delete);
        let selected = std::mem::take(&mut self.selected);
        if selected && removes {
            *self = TextField::default();
            return true;
        }
        match key.code {
            KeyCode::Char('u') if ctrl => {
                let to = self.byte_offset(self.cursor);
                self.text.replace_range(..to, "");
                self.cursor = 0;
            }
            KeyCode::Char('w') if ctrl => self.delete_word(),
            KeyCode::Char(letter) if !ctrl && !key.modifiers.contains(KeyModifiers::ALT) => {
                self.selected = selected;
                self.insert(&letter.to_string());
            }
            KeyCode::Backspace if self.cursor > 0 => {
                self.cursor -= 1;
                self.delete_at_cursor();
            }
            KeyCode::Delete => self.delete_at_cursor(),
            KeyCode::Left => self.cursor = self.cursor.saturating_sub(1),
            KeyCode::Right => self.cursor = (self.cursor + 1).min(self.text.graphemes(true).count()),
            KeyCode::Home => self.cursor = 0,
            KeyCode::End => self.cursor = self.text.graphemes(true).count(),
            KeyCode::Backspace => {}
            _ => return false,
        }
        true
    }

    /// Handles a key in a number field. Returns false if the key is a letter that a number cannot contain.
    pub fn handle_number_key(&mut self, key: &KeyEvent) -> bool {
        let plain = !key.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT);
        match key.code {
            KeyCode::Char(letter) if plain && !is_number_char(letter) => false,
            _ => self.handle_key(key),
        }
    }

    /// Inserts text at the cursor. Line breaks are replaced by spaces. The end of a text that is too long is left out.
    pub fn insert(&mut self, text: &str) {
        if std::mem::take(&mut self.selected) {
            *self = TextField::default();
        }
        let clean: String =
            text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
        let clean = &clean[..clean.floor_char_boundary(MAX_BYTES.saturating_sub(self.text.len()))];
        let at = self.byte_offset(self.cursor);
        self.text.insert_str(at, clean);
        // A combining mark extends the previous grapheme, so the cursor is computed from the byte position.
        self.cursor = self.text[..at + clean.len()].graphemes(true).count();
    }

    /// Inserts a pasted number at the cursor.
    ///
    /// # Errors
    /// The text has characters that numbers cannot contain, or is too long. These characters are left out.
    pub fn paste_number(&mut self, text: &str) -> Result<(), String> {
        let text = text.trim();
        let kept_length = if self.selected { 0 } else { self.text.chars().count() };
        let room = MAX_NUMBER_LENGTH.saturating_sub(kept_length);
        let accepted: String = text.chars().filter(|letter| is_number_char(*letter)).take(room).collect();
        self.insert(&accepted);
        match text.chars().count() - accepted.chars().count() {
            0 => Ok(()),
            count => Err(format!(
                "{} not accepted: a number has digits and a point, and at most {MAX_NUMBER_LENGTH} characters",
                if count == 1 { "1 character was".to_owned() } else { format!("{count} characters were") }
            )),
        }
    }

    fn byte_offset(&self, grapheme: usize) -> usize {
        self.text.grapheme_indices(true).nth(grapheme).map_or(self.text.len(), |(at, _)| at)
    }

    fn delete_at_cursor(&mut self) {
        let (from, to) = (self.byte_offset(self.cursor), self.byte_offset(self.cursor + 1));
        self.text.replace_range(from..to, "");
    }

    fn delete_word(&mut self) {
        let before = &self.text[..self.byte_offset(self.cursor)];
        let kept = before.trim_end();
        let kept = kept.rfind(' ').map_or(0, |at| at + 1);
        let to = before.len();
        self.text.replace_range(kept..to, "");
        self.cursor = self.text[..kept].graphemes(true).count();
    }

    /// Draws the text with its cursor. A long text scrolls horizontally.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        if area.is_empty() {
            return;
        }
        let pieces: Vec<&str> = self.text.graphemes(true).collect();
        let room = (area.width as usize).saturating_sub(1);
        let mut from = 0;
        while pieces[from..self.cursor].concat().width() > room {
            from += 1;
        }
        canvas.clear(Rect { height: 1, ..area }, Role::Field);
        canvas.draw_text(area, "", Role::Field);
        let mut x = area.x;
        let role = if self.selected { Role::Selection } else { Role::Field };
        for piece in &pieces[from..] {
            let width = piece.width() as u16;
            if x + width > area.right() {
                break;
            }
            canvas.draw_text(Rect { x, width: width.max(1), ..area }, piece, role);
            x += width;
        }
        let before = pieces[from..self.cursor].concat().width() as u16;
        canvas.cursor = Some(Position::new((area.x + before).min(area.right() - 1), area.y));
    }
}

/// Message for a letter that is typed into a number field.
pub const NUMBER_HINT: &str = "enter a number: 1200, 1.5k, 2M; esc leaves the field";

fn is_number_char(letter: char) -> bool {
    letter.is_ascii_digit()
        || matches!(letter, '.' | ',' | '_' | '-' | '+' | '$' | 'e' | 'E' | 'k' | 'K' | 'm' | 'M')
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_base::formatting::parse_number;

    fn field_after_keys(keys: &[KeyCode]) -> TextField {
        let mut field = TextField::with_text("añ日");
        for key in keys {
            field.handle_key(&KeyEvent::new(*key, KeyModifiers::NONE));
        }
        field
    }

    #[test]
    fn pasted_number_reports_what_was_left_out() {
        let mut field = TextField::with_selected_text("12");
        assert_eq!(field.paste_number(" 1,200.5 "), Ok(()));
        assert_eq!(field.text(), "1,200.5");
        let problem = field.paste_number("6 units").expect_err("letters");
        assert!(problem.starts_with("6 characters were not accepted: "), "{problem}");
        assert_eq!(field.text(), "1,200.56");
        let mut field = TextField::default();
        let problem = field.paste_number(&"7".repeat(5000)).expect_err("too long");
        assert!(problem.starts_with("4968 characters were not accepted"), "{problem}");
        assert_eq!(field.text(), "7".repeat(32));
        let mut field = TextField::default();
        field.insert(&"日".repeat(5000));
        assert_eq!(field.text().chars().count(), MAX_BYTES / 3, "the start of a long text is kept");
    }

    #[test]
    fn typing_replaces_selected_text() {
        use KeyCode::{Backspace, Char, Left};
        for (keys, text) in [
            (&[Char('7')][..], "7"),
            (&[Char('7'), Char('1')], "71"),
            (&[Left, Char('7')], "172"),
            (&[Backspace], ""),
            (&[Backspace, Char('3')], "3"),
        ] {
            let mut field = TextField::with_selected_text("12");
            for key in keys {
                field.handle_key(&KeyEvent::new(*key, KeyModifiers::NONE));
            }
            assert_eq!(field.text(), text, "{keys:?}");
        }
        let mut pasted = TextField::with_selected_text("12");
        pasted.insert("9");
        assert_eq!(pasted.text(), "9");
    }

    #[test]
    fn cursor_moves_by_graphemes() {
        use KeyCode::{Backspace, Char, Delete, Home, Left, Right};
        for (keys, text) in [
            (&[Backspace][..], "añ"),
            (&[Left, Backspace], "a日"),
            (&[Home, Delete, Delete], "日"),
            (&[Home, Backspace, Char('x')], "xañ日"),
            (&[Right, Right, Char('!')], "añ日!"),
            (&[Left, Left, Left, Left, Char('\u{301}')], "\u{301}añ日"),
        ] {
            assert_eq!(field_after_keys(keys).text(), text, "{keys:?}");
        }
        let mut words = TextField::with_text("one two  ");
        words.handle_key(&KeyEvent::new(KeyCode::Char('w'), KeyModifiers::CONTROL));
        assert_eq!(words.text(), "one ");
    }

    #[test]
    fn number_keys_accept_common_notations() {
        for (text, number) in [
            ("12", Some(12.0)),
            ("1,200.5", Some(1200.5)),
            ("$3.5k", Some(3500.0)),
            ("2M", Some(2e6)),
            ("-4", Some(-4.0)),
            ("", None),
            ("k", None),
            ("inf", None),
            ("nan", None),
            ("1e999", None),
            ("12 x", None),
        ] {
            assert_eq!(parse_number(text), number, "{text}");
            let typed = text.chars().all(|letter| is_number_char(letter) || letter == ' ');
            assert!(typed || number.is_none(), "{text} can be typed");
        }
    }
}
