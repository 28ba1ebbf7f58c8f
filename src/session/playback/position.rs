//! Positions and seek targets of a playback.

use super::record_view::RecordView;

/// The target of a seek.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeekTarget {
    /// The start of the run, before the first action.
    First,
    /// The position after the last line.
    Last,
    /// The position this number of weeks ahead, or back if negative. Single days of debug runs count as weeks.
    Weeks(i32),
    /// The position this number of lines ahead, or back if negative.
    Lines(i32),
    /// The end of the week with this number; 0 is the start of the run.
    Week(u32),
}

/// The result of a seek.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeekResult {
    /// The target was reached in the same session.
    Reached,
    /// The target was reached with a new session. Connections to the old database are stale.
    ReachedInNewSession,
    /// The seek was stopped. A forward seek keeps the reached position; a backward seek keeps the old position.
    Stopped,
}

/// The position of a playback.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaybackPosition {
    /// Number of applied lines.
    pub line: usize,
    /// Number of lines that can be applied.
    pub lines: usize,
    /// Day of the run at the position.
    pub day: u32,
    /// Number of the current week.
    pub week: u32,
    /// Last recorded day.
    pub recorded_day: u32,
    /// Number of recorded weeks.
    pub weeks: u32,
    /// Whether the playback waits for new lines of a running session.
    pub is_following: bool,
    /// Whether all valid lines are applied.
    pub is_at_end: bool,
    /// Decisions before the next week, or before the last week at the end of the run.
    pub chapter: Chapter,
    /// Reason why the run cannot be branched at this position; `None` if it can be branched.
    pub branch_rejection: Option<String>,
}

/// The recorded lines of a week: decisions, and the simulation of the week.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chapter {
    /// Number of the week that the lines belong to, from 1.
    pub week: u32,
    /// Decision day before the week.
    pub day: u32,
    /// Recorded lines up to the end of the week, in order.
    pub entries: Vec<RecordView>,
    /// Number of entries of the chapter up to the current position.
    pub applied_entries: usize,
}
