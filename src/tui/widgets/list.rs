//! Actions of lists, tables and scrolled texts.

/// An action of a list, a table or a scrolled text. The application converts its own actions into these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ListAction {
    /// Selects the row above.
    Up,
    /// Selects the row below.
    Down,
    /// Selects the column to the left.
    Left,
    /// Selects the column to the right.
    Right,
    /// Moves up by a page.
    PageUp,
    /// Moves down by a page.
    PageDown,
    /// Moves to the first row.
    First,
    /// Moves to the last row.
    Last,
    /// Scrolls up by one row, without a selection.
    ScrollUp,
    /// Scrolls down by one row, without a selection.
    ScrollDown,
    /// Sorts by the selected column.
    Sort,
    /// Starts typing a filter.
    Filter,
    /// Accepts the typed filter.
    Commit,
    /// Discards the typed filter.
    Discard,
    /// Clears the filter.
    Close,
}
