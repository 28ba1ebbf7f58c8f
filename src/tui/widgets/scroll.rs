//! The scroll position of a text that is longer than its window.

use std::cell::Cell;

use ratatui::layout::Rect;

use super::ListAction;
use crate::canvas::Canvas;

/// The first visible row of a text, and the maximum for this row.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ScrollState {
    first_row: usize,
    /// The maximum of `first_row`, determined when the last frame was drawn.
    max_first_row: Cell<usize>,
}

impl ScrollState {
    /// Scrolls by rows, by pages of `page` rows, or to the start or end. Returns false if the action does not scroll.
    pub fn handle_action(&mut self, action: impl Into<Option<ListAction>>, page: usize) -> bool {
        let from = self.first_row.min(self.max_first_row.get());
        let to = match action.into() {
            Some(ListAction::Up | ListAction::ScrollUp) => from.saturating_sub(1),
            Some(ListAction::Down | ListAction::ScrollDown) => from + 1,
            Some(ListAction::PageUp) => from.saturating_sub(page),
            Some(ListAction::PageDown) => from + page,
            Some(ListAction::First) => 0,
            Some(ListAction::Last) => usize::MAX,
            _ => return false,
        };
        self.first_row = to.min(self.max_first_row.get());
        true
    }

    /// Scrolls to the end, even if the text grows before the next frame.
    pub fn scroll_to_end(&mut self) {
        self.first_row = usize::MAX;
    }

    /// Returns the first visible row of a text that has `rows` rows. Also draws arrows at the right border of the area
    /// if rows above or below are not visible.
    pub fn scroll_rows(&self, canvas: &mut Canvas<'_>, area: Rect, rows: usize) -> usize {
        let from = self.clamped_first_row(rows.saturating_sub(area.height as usize));
        canvas.draw_scroll_marks(area, from, rows);
        from
    }

    /// Returns the first visible row, limited to `last`.
    pub fn clamped_first_row(&self, last: usize) -> usize {
        self.max_first_row.set(last);
        self.first_row.min(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scrolling_stops_at_the_first_row_and_the_last_page() {
        let mut scroll = ScrollState::default();
        assert_eq!(scroll.clamped_first_row(20), 0);
        let mut after = |action| {
            assert!(scroll.handle_action(action, 8));
            scroll.clamped_first_row(20)
        };
        let moves = [
            ListAction::PageDown,
            ListAction::Down,
            ListAction::Last,
            ListAction::ScrollDown,
            ListAction::PageUp,
            ListAction::First,
        ];
        assert_eq!(moves.map(&mut after), [8, 9, 20, 20, 12, 0]);
        assert!(!scroll.handle_action(ListAction::Sort, 8));
        scroll.handle_action(ListAction::Last, 8);
        assert_eq!(scroll.clamped_first_row(3), 3, "the window has grown");
        scroll.scroll_to_end();
        assert_eq!(scroll.clamped_first_row(40), 40, "the text has grown");
        scroll.handle_action(ListAction::Up, 8);
        assert_eq!(scroll.clamped_first_row(40), 39);
    }
}
