//! Positions and seek targets of a playback.

use super::record_view::RecordView;

/// The target of a seek.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeekTarget {
    /// Before the first action.
    First,
    /// After the last line.
    Last,
    /// This number of weeks forward, or back if negative. Single steps of debug runs count as weeks.
    Weeks(i32),
    /// This number of lines forward, or back if negative.
    Lines(i32),
    /// The end of a week, by number; 0 is the start.
    Week(u32),
}

/// The result of a seek.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeekResult {
    /// The target was reached.
    Reached,
    /// The target was reached with a new session; connections to the old database are stale.
    ReachedInNewSession,
    /// The seek was stopped. Forward, the reached position is kept; back, the old position is kept.
    Stopped,
}

/// The position of a playback.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaybackPosition {
    /// Number of applied lines.
    pub line: usize,
    /// Number of lines.
    pub lines: usize,
    /// Day of the run.
    pub day: u32,
    /// Number of weeks that have passed.
    pub week: u32,
    /// Last recorded day.
    pub recorded_day: u32,
    /// Number of recorded weeks.
    pub weeks: u32,
    /// Whether the playback waits for new lines of a running session.
    pub is_following: bool,
    /// Whether the playback is after the last line.
    pub is_at_end: bool,
    /// Decisions before the next week, or before the last one at the end.
    pub chapter: Chapter,
    /// Reason why the run cannot be branched here.
    pub branch_rejection: Option<String>,
}

/// Decisions before a week.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chapter {
    /// Number of the week, from 1.
    pub week: u32,
    /// Decision day.
    pub day: u32,
    /// Lines up to the end of the week, in order.
    pub entries: Vec<RecordView>,
    /// Number of these lines that are applied.
    pub applied_entries: usize,
}
