//! Where a playback is, and where it can be sent.

use super::record_view::RecordView;

/// Where a playback is to go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goal {
    /// Before the first action.
    First,
    /// After the last line.
    Last,
    /// So many weeks on, or back if negative. Single steps of debug runs count for themselves.
    Weeks(i32),
    /// So many lines on, or back if negative.
    Lines(i32),
    /// After a week, by its number; 0 is the beginning.
    Week(u32),
}

/// What became of going somewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeekResult {
    /// It is there.
    There,
    /// It is there with a new session: connections to the old one's database show nothing new.
    Anew,
    /// It was stopped on the way; what was reached is shown, and going back leaves everything where it was.
    Stopped,
}

/// Where a playback is.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaybackPosition {
    /// Lines that were applied.
    pub line: usize,
    /// Lines that there are.
    pub lines: usize,
    /// Day of the company.
    pub day: u32,
    /// Weeks that have passed.
    pub week: u32,
    /// Last day that was recorded.
    pub recorded_day: u32,
    /// Weeks that were recorded.
    pub weeks: u32,
    /// New lines are awaited: somebody else is playing.
    pub follows: bool,
    /// Nothing comes after this moment.
    pub at_end: bool,
    /// What was decided before the next week, or before the last one at the end.
    pub chapter: Chapter,
    /// Why the run cannot be taken over here.
    pub no_branch: Option<String>,
}

/// What was decided before a week.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chapter {
    /// Number of the week, from 1.
    pub week: u32,
    /// Decision day.
    pub day: u32,
    /// What was done, in order, up to the line that closes the week.
    pub entries: Vec<RecordView>,
    /// How many of them were applied: the others are still to come.
    pub done: usize,
}
