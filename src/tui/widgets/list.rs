//! Actions of lists, tables and scrolled texts.

/// An action of a list, a table or a scrolled text. The application maps its keys to these actions.
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
    /// Moves the selection up by a page.
    PageUp,
    /// Moves the selection down by a page.
    PageDown,
    /// Moves the selection to the first row.
    First,
    /// Moves the selection to the last row.
    Last,
    /// Scrolls a text by one row toward its start.
    ScrollUp,
    /// Scrolls a text by one row toward its end.
    ScrollDown,
    /// Sorts by the selected column.
    Sort,
    /// Opens the filter field.
    Filter,
    /// Accepts the typed filter.
    Commit,
    /// Discards the typed filter.
    Discard,
    /// Clears the filter, if a filter is set.
    Close,
}
