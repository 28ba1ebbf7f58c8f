//! A consent text. The user can agree only after its end was on the screen.

use std::cell::Cell;
use std::time::Duration;

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::action::Action;
use novamind_record::clock::steady;
use novamind_record::consent::{ConsentGiven, ConsentMeans};
use novamind_report::prose::{Face, laid_out};
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::theme::Role;
use novamind_tui::widgets::Scroll;

/// Maximum line width that is easy to read.
const WIDEST: u16 = 100;

/// Shown if the user agrees before the end of the text was on the screen.
pub const READ_FIRST: &str = "scroll to the end of the text first";

/// A consent text, and whether its end was reached.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    text: String,
    scroll: Scroll,
    shown: Duration,
    room: Cell<usize>,
    /// Whether the last line was on the screen.
    read: Cell<bool>,
}

impl Agreement {
    /// Returns an unread consent text.
    pub fn new(text: impl Into<String>) -> Agreement {
        Agreement {
            text: text.into(),
            scroll: Scroll::default(),
            shown: steady(),
            room: Cell::new(1),
            read: Cell::new(false),
        }
    }

    /// Returns how the user agrees, or `None` if the end of the text was not on the screen yet.
    pub fn given(&self) -> Option<ConsentGiven> {
        let read_ms = steady().saturating_sub(self.shown).as_millis() as u64;
        let given = ConsentGiven { means: ConsentMeans::Screen, scrolled_to_end: true, read_ms };
        self.read.get().then_some(given)
    }

    /// Scrolls the text. Returns whether the action was a scroll action.
    pub fn scroll(&mut self, action: Action) -> bool {
        self.scroll.act(action, self.room.get().max(1))
    }

    /// Draws the text and the choices below it. `agree` and `decline` are their labels with keys.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, title: &str, agree: &str, decline: &str) {
        canvas.clear(area, Role::Text);
        let width = area.width.saturating_sub(4).clamp(1, WIDEST);
        let lines = laid_out(&self.text, width as usize);
        let room = area.height.saturating_sub(4) as usize;
        let last = lines.len().saturating_sub(room);
        let from = self.scroll.within(last);
        self.room.set(room);
        if from == last && room > 0 {
            self.read.set(true);
        }
        let note = match last {
            0 => String::new(),
            _ => format!("lines {} to {} of {}", from + 1, (from + room).min(lines.len()), lines.len()),
        };
        let inside = canvas.pane(area, title, &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        canvas.page = (room as u16).max(1);
        let text = Rect { height: (room as u16).min(inside.height), ..inside };
        for (row, line) in rows_of(text).zip(lines.iter().skip(from)) {
            let mut left = row;
            for (piece, face) in line {
                let role = match face {
                    Face::Text => Role::Text,
                    Face::Strong => Role::Strong,
                    Face::Heading => Role::Header,
                };
                canvas.text(left, piece, role);
                let taken = (piece.width() as u16).min(left.width);
                left = Rect { x: left.x + taken, width: left.width - taken, ..left };
            }
        }
        let below = Rect { y: inside.bottom().saturating_sub(1), height: inside.height.min(1), ..inside };
        match self.read.get() {
            true => canvas.text(below, &format!("{agree}   {decline}"), Role::Strong),
            false => canvas.text(below, &format!("scroll to the end to agree   {decline}"), Role::Warning),
        }
        if last > 0 {
            canvas.pane_keys(area, "up/down/page down scroll");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::painted;

    fn drawn(agreement: &Agreement, height: u16) -> String {
        painted(60, height, |canvas, area| agreement.draw(canvas, area, "Consent", "y agree", "n not"))
            .join("\n")
    }

    #[test]
    fn nobody_agrees_before_the_end_was_on_the_screen() {
        let text = (1..=30).map(|line| format!("- line {line}.")).collect::<Vec<_>>().join("\n");
        let mut long = Agreement::new(text);
        assert!(drawn(&long, 16).contains("scroll to the end"));
        assert_eq!(long.given(), None);
        for _ in 0..2 {
            long.scroll(Action::PageDown);
            drawn(&long, 16);
        }
        assert!(long.given().is_some_and(|given| given.scrolled_to_end), "{}", drawn(&long, 16));
        assert!(drawn(&long, 16).contains("line 30.") && drawn(&long, 16).contains("y agree"));
        long.scroll(Action::First);
        assert!(drawn(&long, 16).contains("line 1."));
        assert!(long.given().is_some(), "scrolling back does not revoke it");
    }

    #[test]
    fn what_fits_is_read_and_what_was_not_drawn_is_not() {
        let short = Agreement::new("One line.");
        assert_eq!(short.given(), None);
        for (width, height) in [(0, 0), (1, 1), (3, 2), (20, 3)] {
            painted(width, height, |canvas, area| short.draw(canvas, area, "Consent", "y", "n"));
        }
        assert_eq!(short.given(), None, "no line was on the screen");
        drawn(&short, 10);
        assert!(short.given().is_some());
    }
}
