//! Playback state in the console: position, speed and displayed decisions.

mod activities;
mod decisions_pane;
pub mod entry_text;
mod status_line;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

pub use decisions_pane::EntryFilter;

use novamind_session::PlaybackPosition;

/// Pause between two weeks in milliseconds, and the label of the speed.
const SPEEDS: [(u64, &str); 6] = [
    (4_000, "¼ week per second"),
    (2_000, "½ week per second"),
    (1_000, "1 week per second"),
    (500, "2 weeks per second"),
    (200, "5 weeks per second"),
    (0, "full speed"),
];

/// The state of a playback in the console.
pub struct PlaybackViewer {
    /// The current position in the record.
    pub position: PlaybackPosition,
    /// Whether the playback is running, not paused.
    pub playing: bool,
    /// Whether the decisions are shown next to the screen if there is space.
    pub shows_decisions: bool,
    /// Whether the playback is seeking a position.
    pub is_seeking: bool,
    /// Flag that stops seeking when set.
    pub stop_flag: Arc<AtomicBool>,
    /// Whether the next week was requested.
    pub has_requested_week: bool,
    speed: usize,
    /// Number of rows by which the user has scrolled the decisions away from the current position.
    scroll: i32,
}

impl PlaybackViewer {
    /// Minimum width for the decisions next to the screen, in columns.
    pub const MIN_WIDTH_FOR_DECISIONS: u16 = 120;

    /// Returns a paused playback.
    pub fn new(place: PlaybackPosition) -> PlaybackViewer {
        PlaybackViewer {
            position: place,
            playing: false,
            shows_decisions: true,
            is_seeking: false,
            stop_flag: Arc::default(),
            has_requested_week: false,
            speed: 2,
            scroll: 0,
        }
    }

    /// Sets the position that the playback has reached.
    pub fn update_position(&mut self, place: PlaybackPosition, asked: bool) {
        if place.line != self.position.line {
            self.scroll = 0;
        }
        self.position = place;
        self.has_requested_week = false;
        if asked {
            self.is_seeking = false;
        }
    }

    /// Changes the playback speed by one step.
    pub fn change_speed(&mut self, faster: bool) {
        let speed = if faster { self.speed + 1 } else { self.speed.saturating_sub(1) };
        self.speed = speed.min(SPEEDS.len() - 1);
    }

    /// Returns the label of the playback speed.
    pub fn speed_label(&self) -> &'static str {
        SPEEDS[self.speed].1
    }

    /// Returns the pause between two weeks.
    pub fn week_interval(&self) -> Duration {
        Duration::from_millis(SPEEDS[self.speed].0)
    }

    /// Scrolls the pane with the decisions by a number of rows.
    pub fn scroll_by(&mut self, rows: i32) {
        self.scroll = (self.scroll + rows).clamp(-10_000, 10_000);
    }
}
