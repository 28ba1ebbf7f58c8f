//! The scroll position of a text that is longer than its window.

use std::cell::Cell;

use super::ListAction;

/// The first visible row, and the last possible one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scroll {
    from: usize,
    /// The last useful position, as of the last frame.
    last: Cell<usize>,
}

impl Scroll {
    /// Scrolls by rows, by pages of `page` rows, or to an end. Returns whether the action was a scroll action.
    pub fn act(&mut self, action: impl Into<Option<ListAction>>, page: usize) -> bool {
        let from = self.from.min(self.last.get());
        let to = match action.into() {
            Some(ListAction::Up | ListAction::ScrollUp) => from.saturating_sub(1),
            Some(ListAction::Down | ListAction::ScrollDown) => from + 1,
            Some(ListAction::PageUp) => from.saturating_sub(page),
            Some(ListAction::PageDown) => from + page,
            Some(ListAction::First) => 0,
            Some(ListAction::Last) => usize::MAX,
            _ => return false,
        };
        self.from = to.min(self.last.get());
        true
    }

    /// Scrolls to the end, even if the text grows before the next frame.
    pub fn show_end(&mut self) {
        self.from = usize::MAX;
    }

    /// Returns the first visible row, limited to `last`.
    pub fn within(&self, last: usize) -> usize {
        self.last.set(last);
        self.from.min(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_stays_between_the_first_row_and_the_last_page() {
        let mut scroll = Scroll::default();
        assert_eq!(scroll.within(20), 0);
        let mut after = |action| {
            assert!(scroll.act(action, 8));
            scroll.within(20)
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
        assert!(!scroll.act(ListAction::Sort, 8));
        scroll.act(ListAction::Last, 8);
        assert_eq!(scroll.within(3), 3, "the window has grown");
        scroll.show_end();
        assert_eq!(scroll.within(40), 40, "the text has grown");
        scroll.act(ListAction::Up, 8);
        assert_eq!(scroll.within(40), 39);
    }
}
