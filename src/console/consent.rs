//! A consent text. The user can agree only after its end was on the screen.

use std::cell::Cell;
use std::time::Duration;

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::action::Action;
use novamind_record::clock::monotonic_time;
use novamind_record::consent::{ConsentDetails, ConsentMeans};
use novamind_report::prose::{TextStyle, lay_out};
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::theme::Role;
use novamind_tui::widgets::ScrollState;

/// Maximum line width that is easy to read.
const MAX_TEXT_WIDTH: u16 = 100;

/// Shown if the user agrees before the end of the text was on the screen.
pub const UNREAD_ERROR: &str = "scroll to the end of the text first";

/// A consent text, and whether its end was on the screen.
#[derive(Debug, Clone, PartialEq)]
pub struct ConsentText {
    text: String,
    scroll: ScrollState,
    shown_at: Duration,
    visible_rows: Cell<usize>,
    /// Whether the last line was on the screen.
    is_read: Cell<bool>,
}

impl ConsentText {
    /// Returns an unread consent text.
    pub fn new(text: impl Into<String>) -> ConsentText {
        ConsentText {
            text: text.into(),
            scroll: ScrollState::default(),
            shown_at: monotonic_time(),
            visible_rows: Cell::new(1),
            is_read: Cell::new(false),
        }
    }

    /// Returns the consent of the user, or `None` if the end of the text was not on the screen yet.
    pub fn consent(&self) -> Option<ConsentDetails> {
        let read_ms = monotonic_time().saturating_sub(self.shown_at).as_millis() as u64;
        let consent_given = ConsentDetails { means: ConsentMeans::Screen, scrolled_to_end: true, read_ms };
        self.is_read.get().then_some(consent_given)
    }

    /// Scrolls the consent text. Returns whether the action was a scroll action.
    pub fn handle_scroll(&mut self, action: Action) -> bool {
        self.scroll.handle_action(action, self.visible_rows.get().max(1))
    }

    /// Draws the text and the choices below it. `agree` and `decline` are the labels of the two choices, including
    /// their keys.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, title: &str, agree: &str, decline: &str) {
        canvas.clear(area, Role::Text);
        let width = area.width.saturating_sub(4).clamp(1, MAX_TEXT_WIDTH);
        let lines = lay_out(&self.text, width as usize);
        let room = area.height.saturating_sub(4) as usize;
        let last = lines.len().saturating_sub(room);
        let from = self.scroll.clamped_first_row(last);
        self.visible_rows.set(room);
        if from == last && room > 0 {
            self.is_read.set(true);
        }
        let note = match last {
            0 => String::new(),
            _ => format!("lines {} to {} of {}", from + 1, (from + room).min(lines.len()), lines.len()),
        };
        let inside = canvas.draw_pane_frame(area, title, &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        canvas.page_rows = (room as u16).max(1);
        let text = Rect { height: (room as u16).min(inside.height), ..inside };
        for (row, line) in row_rects(text).zip(lines.iter().skip(from)) {
            let mut left = row;
            for (piece, face) in line {
                let role = match face {
                    TextStyle::Text => Role::Text,
                    TextStyle::Strong => Role::Strong,
                    TextStyle::Heading => Role::Header,
                };
                canvas.draw_text(left, piece, role);
                let taken = (piece.width() as u16).min(left.width);
                left = Rect { x: left.x + taken, width: left.width - taken, ..left };
            }
        }
        let below = Rect { y: inside.bottom().saturating_sub(1), height: inside.height.min(1), ..inside };
        match self.is_read.get() {
            true => canvas.draw_text(below, &format!("{agree}   {decline}"), Role::Strong),
            false => {
                canvas.draw_text(below, &format!("scroll to the end to agree   {decline}"), Role::Warning)
            }
        }
        if last > 0 {
            canvas.draw_pane_keys(area, "up/down/page down scroll");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::render_rows;

    fn draw_to_text(agreement: &ConsentText, height: u16) -> String {
        render_rows(60, height, |canvas, area| agreement.draw(canvas, area, "Consent", "y agree", "n not"))
            .join("\n")
    }

    #[test]
    fn consent_requires_that_the_end_of_the_text_was_shown() {
        let text = (1..=30).map(|line| format!("- line {line}.")).collect::<Vec<_>>().join("\n");
        let mut long = ConsentText::new(text);
        assert!(draw_to_text(&long, 16).contains("scroll to the end"));
        assert_eq!(long.consent(), None);
        for _ in 0..2 {
            long.handle_scroll(Action::PageDown);
            draw_to_text(&long, 16);
        }
        assert!(
            long.consent().is_some_and(|consent_given| consent_given.scrolled_to_end),
            "{}",
            draw_to_text(&long, 16)
        );
        assert!(draw_to_text(&long, 16).contains("line 30.") && draw_to_text(&long, 16).contains("y agree"));
        long.handle_scroll(Action::First);
        assert!(draw_to_text(&long, 16).contains("line 1."));
        assert!(long.consent().is_some(), "scrolling back does not revoke it");
    }

    #[test]
    fn text_counts_as_read_once_its_end_is_drawn() {
        let short = ConsentText::new("One line.");
        assert_eq!(short.consent(), None);
        for (width, height) in [(0, 0), (1, 1), (3, 2), (20, 3)] {
            render_rows(width, height, |canvas, area| short.draw(canvas, area, "Consent", "y", "n"));
        }
        assert_eq!(short.consent(), None, "no line was on the screen");
        draw_to_text(&short, 10);
        assert!(short.consent().is_some());
    }
}
