//! The time in which a week was decided, and when that was implausibly short. The one definition, for tables and audit.

use super::attendance::{Attendance, TimeSpent};

/// Active seconds below which a week was decided implausibly fast: nobody reads a week in them.
pub const FAST_WEEK_SECONDS: f64 = 10.0;

/// What came before the end of a week, or of single days, on the axis of the run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct AttendedWeek {
    /// Where the week before it ended, nanoseconds.
    pub from: i64,
    /// Where it ended, nanoseconds.
    pub to: i64,
    /// It was taken over from the run that this one branched from: nobody played it here.
    pub inherited: bool,
}

impl AttendedWeek {
    /// Whether it was decided here, in less than [`FAST_WEEK_SECONDS`] active seconds.
    pub fn is_implausibly_fast(&self, time: &TimeSpent) -> bool {
        !self.inherited && time.active_seconds() < FAST_WEEK_SECONDS
    }
}

impl Attendance {
    /// Weeks that were decided implausibly fast.
    pub fn fast_weeks(&self) -> u32 {
        let is_fast = |week: &&AttendedWeek| week.is_implausibly_fast(&self.between(week.from, week.to));
        self.weeks().iter().filter(is_fast).count() as u32
    }
}
